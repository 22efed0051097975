// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/run/run_trials.h"

#include <fmt/core.h>
#include <tbb/global_control.h>
#include <tbb/parallel_pipeline.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <optional>
#include <thread>

#include "eval/experiment/run/row_file.h"

namespace sextant {
namespace {

struct FinishedBlock {
  std::string bytes;
  std::uint64_t trials = 0;
};

struct TrialRange {
  std::uint64_t condition = 0;
  std::uint64_t first = 0;
  std::uint64_t end = 0;
};

TrialRange RangeOf(const Experiment& experiment, std::uint64_t block) {
  const auto size = static_cast<std::uint64_t>(experiment.trials_per_block);
  const std::uint64_t per_condition = BlocksPerCondition(experiment);
  const std::uint64_t first = block % per_condition * size;
  return {block / per_condition, first, std::min(first + size, experiment.trials)};
}

FinishedBlock RunBlock(const Experiment& experiment, std::uint64_t block) {
  const TrialRange range = RangeOf(experiment, block);
  const Condition& condition = experiment.conditions[range.condition];
  TrialRows rows(experiment.metrics.size(), experiment.wanted);
  for (std::uint64_t trial = range.first; trial < range.end; ++trial) {
    rows.BeginTrial(trial);
    condition.trials->Run({.trial = trial, .seed = SeedOf(experiment, condition, trial)}, rows);
  }
  return {MakeRowBlock(block, range.first, rows).Encode(), range.end - range.first};
}

// The blocks of the shard in ascending order.
std::vector<std::uint64_t> BlocksOfShard(const Experiment& experiment, const Shard& shard) {
  std::vector<std::uint64_t> blocks;
  for (std::uint64_t b = shard.number; b < BlocksOf(experiment); b += shard.of) blocks.push_back(b);
  return blocks;
}

Expected<void> CheckKept(const RowFileWriter& writer, const std::vector<std::uint64_t>& blocks,
                         const RunSettings& settings) {
  const std::vector<std::uint64_t>& kept = writer.kept();
  const auto is_of_shard = [&blocks](std::uint64_t block) {
    return std::binary_search(blocks.begin(), blocks.end(), block);
  };
  const bool has_gaps = !settings.held.empty() || !writer.is_orderly();
  const bool fits = has_gaps ? std::all_of(kept.begin(), kept.end(), is_of_shard)
                             : kept.size() <= blocks.size() &&
                                   std::equal(kept.begin(), kept.end(), blocks.begin());
  if (fits) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("'{}' holds blocks of another --shard; start over with --fresh, or "
                               "choose another folder with --out",
                               settings.rows_path.string()));
}

// The blocks that are neither in this file nor in another one.
std::vector<std::uint64_t> Missing(std::vector<std::uint64_t> blocks,
                                   std::vector<std::uint64_t> kept,
                                   const std::vector<std::uint64_t>& held) {
  std::sort(kept.begin(), kept.end());
  std::erase_if(blocks, [&](std::uint64_t block) {
    return std::binary_search(kept.begin(), kept.end(), block) ||
           std::binary_search(held.begin(), held.end(), block);
  });
  return blocks;
}

// Runs blocks on all threads and writes them in order; the number of blocks in flight is bounded.
class BlockPipeline {
 public:
  BlockPipeline(const Experiment& experiment, std::vector<std::uint64_t> blocks,
                const RunSettings& settings, RowFileWriter& writer)
      : experiment_(experiment), blocks_(std::move(blocks)), settings_(settings), writer_(writer) {
    for (const std::uint64_t block : blocks_) to_do_ += TrialsOfBlock(experiment_, block);
  }

  Expected<std::uint64_t> Run() {
    const int threads = settings_.threads > 0
                            ? settings_.threads
                            : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    static_cast<std::size_t>(threads));
    settings_.after_block(0, to_do_);
    tbb::task_arena arena(threads);
    arena.execute([&] { Pipe(4 * static_cast<std::size_t>(threads)); });
    if (error_) return tl::unexpected<Error>(*error_);
    return done_;
  }

 private:
  void Pipe(std::size_t blocks_in_flight) {
    const auto number = tbb::make_filter<void, std::uint64_t>(
        tbb::filter_mode::serial_in_order, [this](tbb::flow_control& flow) -> std::uint64_t {
          if (failed_ || next_ == blocks_.size()) {
            flow.stop();
            return 0;
          }
          return blocks_[next_++];
        });
    const auto run = tbb::make_filter<std::uint64_t, FinishedBlock>(
        tbb::filter_mode::parallel,
        [this](std::uint64_t block) { return RunBlock(experiment_, block); });
    const auto write = tbb::make_filter<FinishedBlock, void>(
        tbb::filter_mode::serial_in_order, [this](const FinishedBlock& block) { Write(block); });
    tbb::parallel_pipeline(blocks_in_flight, number & run & write);
  }

  void Write(const FinishedBlock& block) {
    if (error_) return;
    if (Expected<void> ok = writer_.Append(block.bytes); !ok) {
      error_ = std::move(ok.error());
      failed_ = true;
      return;
    }
    done_ += block.trials;
    settings_.after_block(done_, to_do_);
  }

  const Experiment& experiment_;
  std::vector<std::uint64_t> blocks_;
  std::size_t next_ = 0;
  const RunSettings& settings_;
  RowFileWriter& writer_;
  std::uint64_t to_do_ = 0;
  std::uint64_t done_ = 0;
  std::atomic<bool> failed_{false};
  std::optional<Error> error_;
};

}  // namespace

std::uint64_t TrialsOfBlock(const Experiment& experiment, std::uint64_t block) {
  const TrialRange range = RangeOf(experiment, block);
  return range.end - range.first;
}

std::uint64_t BlocksPerCondition(const Experiment& experiment) {
  const auto size = static_cast<std::uint64_t>(experiment.trials_per_block);
  return (experiment.trials + size - 1) / size;
}

std::uint64_t BlocksOf(const Experiment& experiment) {
  return experiment.conditions.size() * BlocksPerCondition(experiment);
}

Expected<RunOutcome> RunTrials(const Experiment& experiment, const RunSettings& settings) {
  SEXTANT_ASSIGN_OR_RETURN(
      RowFileWriter writer,
      RowFileWriter::Open(settings.rows_path, ConfigurationOf(experiment), settings.fresh));
  std::vector<std::uint64_t> blocks = BlocksOfShard(experiment, settings.shard);
  SEXTANT_RETURN_IF_ERROR(CheckKept(writer, blocks, settings));
  RunOutcome outcome{.damage = writer.damage()};
  for (const std::uint64_t block : writer.kept()) {
    outcome.kept_trials += TrialsOfBlock(experiment, block);
  }
  blocks = Missing(std::move(blocks), writer.kept(), settings.held);
  SEXTANT_ASSIGN_OR_RETURN(std::uint64_t run,
                           BlockPipeline(experiment, std::move(blocks), settings, writer).Run());
  outcome.run_trials = run;
  SEXTANT_RETURN_IF_ERROR(writer.Flush());
  if (!writer.is_orderly()) SEXTANT_RETURN_IF_ERROR(OrderRowFile(settings.rows_path));
  return outcome;
}

}  // namespace sextant
