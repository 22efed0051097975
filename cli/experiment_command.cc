// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <charconv>
#include <filesystem>
#include <optional>

#include "cli/commands.h"
#include "cli/experiment_run.h"
#include "cli/load.h"
#include "eval/experiment/kinds/kinds_page.h"
#include "eval/experiment/run/part_files.h"

namespace sextant::cli {
namespace {

Expected<Shard> ParseShard(const std::string& text) {
  if (text.empty()) return Shard{};
  const auto number = [](std::string_view digits) {
    std::uint64_t value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && stop == digits.data() + digits.size() ? value : 0;
  };
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const std::uint64_t i = number(std::string_view{text}.substr(0, slash));
    const std::uint64_t n = number(std::string_view{text}.substr(slash + 1));
    if (i >= 1 && i <= n) return Shard{.number = i - 1, .of = n};
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("--shard {}: expected I/N with 1 <= I <= N, as 2/8", text));
}

void TellKept(const RunOutcome& outcome, const std::filesystem::path& rows) {
  if (outcome.kept_trials == 0) return;
  fmt::print(stderr, "sextant run: {} of {} trials were already in {}{}\n", outcome.kept_trials,
             outcome.kept_trials + outcome.run_trials, rows.string(),
             outcome.run_trials == 0 ? "; --fresh runs them anew" : "");
}

}  // namespace

int RunExperiment(const ExperimentOptions& options) {
  const Expected<Experiment> experiment = LoadExperiment(options);
  if (!experiment) return Refuse("run", experiment.error());
  const Expected<Shard> shard = ParseShard(options.shard);
  if (!shard) return Refuse("run", shard.error());
  const std::filesystem::path folder = FolderOf(options, *experiment);
  if (Expected<void> ok = MakeFolder(folder); !ok) return Refuse("run", ok.error());
  const bool whole = shard->of == 1;
  const std::filesystem::path rows = folder / (whole ? "rows.sxtrows" : PartFileName(*shard));
  const Expected<RunOutcome> outcome = RunWithProgress(
      *experiment,
      {.rows_path = rows, .threads = options.threads, .fresh = options.fresh, .shard = *shard});
  if (!outcome) return Refuse("run", outcome.error());
  TellKept(*outcome, rows);
  if (whole) return WriteAll("run", options, *experiment, folder);
  fmt::print("written to {}; join the shards with sextant merge\n", rows.string());
  return kAnswered;
}

int RunMerge(const ExperimentOptions& options) {
  const Expected<Experiment> experiment = LoadExperiment(options);
  if (!experiment) return Refuse("merge", experiment.error());
  const std::filesystem::path folder = FolderOf(options, *experiment);
  if (Expected<void> ok = MakeFolder(folder); !ok) return Refuse("merge", ok.error());
  const std::vector<std::filesystem::path> shards(options.row_files.begin(),
                                                  options.row_files.end());
  if (Expected<void> ok = MergeRowFiles(shards, folder / "rows.sxtrows"); !ok) {
    return Refuse("merge", ok.error());
  }
  return WriteTables("merge", options, *experiment, folder);
}

int RunKinds() {
  fmt::print("{}", FormatKindsPage(BuiltinKinds()));
  return kAnswered;
}

}  // namespace sextant::cli
