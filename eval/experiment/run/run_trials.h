// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/definition/experiment.h"

namespace sextant {

/// Which part of an experiment is run: every `of`-th block, from `number` (from 0).
struct Shard {
  std::uint64_t number = 0;
  std::uint64_t of = 1;
};

struct RunSettings {
  std::filesystem::path rows_path{};
  int threads = 0;     ///< 0: as many as the machine has.
  bool fresh = false;  ///< Rows that are there are thrown away.
  Shard shard{};
  /// Blocks that other row files hold, ascending: they are not run. Where some are named, the file
  /// may hold any blocks of its shard; otherwise only the first of them, in order.
  std::vector<std::uint64_t> held{};
  /// After each block, in order: trials done of trials to do in this call. Also before the first.
  std::function<void(std::uint64_t, std::uint64_t)> after_block = [](std::uint64_t, std::uint64_t) {
  };
};

struct RunOutcome {
  std::uint64_t kept_trials = 0;  ///< Found in the file.
  std::uint64_t run_trials = 0;
};

/// Runs the trials that the row file does not yet hold and appends them, block by block in order.
/// The bytes depend on the experiment, the shard and what others held alone: not on threads, nor on
/// how often the run was interrupted. Memory does not grow with the number of trials. Errors: those
/// of RowFileWriter.
Expected<RunOutcome> RunTrials(const Experiment& experiment, const RunSettings& settings);

/// What the rows depend on, as the JSON with which the row file begins.
std::string ConfigurationOf(const Experiment& experiment);

std::uint64_t TrialsOfBlock(const Experiment& experiment, std::uint64_t block);

/// Blocks of one condition, and of all.
std::uint64_t BlocksPerCondition(const Experiment& experiment);
std::uint64_t BlocksOf(const Experiment& experiment);

/// Joins the row files of all shards to the file that one run writes, byte for byte. Errors:
/// kInvalidInput (files of different experiments; blocks that no file has, and how many).
Expected<void> MergeRowFiles(const std::vector<std::filesystem::path>& shards,
                             const std::filesystem::path& merged);

}  // namespace sextant
