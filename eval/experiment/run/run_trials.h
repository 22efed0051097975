// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/call_files.h"
#include "base/error.h"
#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/run/configuration.h"

namespace sextant {

/// The part of an experiment that is run: every `of`-th block, starting with block `number` (from
/// 0).
struct Shard {
  std::uint64_t number = 0;
  std::uint64_t of = 1;
};

struct RunSettings {
  std::filesystem::path rows_path{};
  int threads = 0;     ///< 0: one per hardware thread.
  bool fresh = false;  ///< Discard existing rows.
  Shard shard{};
  /// Blocks in other row files, ascending; they are not run. If there are some, this file may hold
  /// any blocks of its shard; otherwise it must hold the first ones of the shard, in order.
  std::vector<std::uint64_t> held{};
  /// Called before the first and after each block, in order, with the trials done and to do in this
  /// call.
  std::function<void(std::uint64_t, std::uint64_t)> after_block = [](std::uint64_t, std::uint64_t) {
  };
};

struct RunOutcome {
  std::uint64_t kept_trials = 0;  ///< Trials that were already in the file.
  std::uint64_t run_trials = 0;
  std::vector<std::string> damage{};  ///< Parts of the file whose trials were run again; see
                                      ///< DescribeDamage.
};

/// Runs the trials that are not yet in the row file and appends them, block by block in order. The
/// bytes depend only on the experiment, the shard and the held blocks, not on the number of
/// threads, on interruptions or on damage to the file in between: the trials of damaged blocks are
/// run again. Memory does not grow with the number of trials. Errors: those of RowFileWriter.
Expected<RunOutcome> RunTrials(const Experiment& experiment, const RunSettings& settings);

/// Number of trials of a block.
std::uint64_t TrialsOfBlock(const Experiment& experiment, std::uint64_t block);

/// Number of blocks of one condition, and of the whole experiment.
std::uint64_t BlocksPerCondition(const Experiment& experiment);
std::uint64_t BlocksOf(const Experiment& experiment);

/// Merges the row files of all shards into the file that a single run writes, byte for byte. All
/// must have this configuration, and so must an existing file, which is then replaced as a whole;
/// with --overwrite it may be any. Nothing is replaced before all is checked. `use.may_be_read`:
/// the merged file may be one of the shards. Errors: kInvalidInput (files of different experiments;
/// missing blocks, with their number); those of RowFileReader and OutputFile.
Expected<void> MergeRowFiles(const std::vector<std::filesystem::path>& shards,
                             const std::filesystem::path& merged, const std::string& configuration,
                             OutputUse use = {});

}  // namespace sextant
