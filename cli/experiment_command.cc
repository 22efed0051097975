// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <memory>
#include <optional>

#include "cli/catalogue.h"
#include "cli/commands.h"
#include "cli/load.h"
#include "cli/progress.h"
#include "eval/experiment/kinds_page.h"
#include "eval/experiment/run_trials.h"
#include "eval/experiment/timing.h"
#include "eval/experiment/write_report.h"
#include "io/text_file.h"

namespace sextant::cli {
namespace {

Expected<Experiment> LoadExperiment(const ExperimentOptions& options) {
  Expected<Experiment> experiment =
      ReadExperiment(options.experiment_path, BuiltinKinds(), AllSolvers(), options.solvers);
  if (!experiment) return experiment;
  if (options.quick) experiment->trials = experiment->quick_trials;
  if (options.trials > 0) experiment->trials = options.trials;
  if (options.seed) experiment->seed = *options.seed;
  return experiment;
}

Expected<std::filesystem::path> MakeFolder(const ExperimentOptions& options,
                                           const Experiment& experiment) {
  const std::filesystem::path folder =
      !options.out.empty()
          ? std::filesystem::path(options.out)
          : std::filesystem::path("results") / (experiment.name + (options.quick ? "-quick" : ""));
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && std::filesystem::is_directory(folder, error)) return folder;
  return MakeError(ErrorCode::kIo, fmt::format("cannot make the folder '{}': {}; name another "
                                               "with --out",
                                               folder.string(), error.message()));
}

Expected<Shard> ParseShard(const std::string& text) {
  if (text.empty()) return Shard{};
  const auto number = [](std::string_view digits) {
    std::uint64_t value = 0;
    const auto [stop, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    return error == std::errc() && stop == digits.data() + digits.size() ? value : 0;
  };
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const std::uint64_t i = number(std::string_view(text).substr(0, slash));
    const std::uint64_t n = number(std::string_view(text).substr(slash + 1));
    if (i >= 1 && i <= n) return Shard{.number = i - 1, .of = n};
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("--shard {}: expected I/N with 1 <= I <= N, as 2/8", text));
}

Expected<RunOutcome> RunWithProgress(const Experiment& experiment, RunSettings settings) {
  std::unique_ptr<Progress> progress;
  settings.after_block = [&](std::uint64_t done, std::uint64_t all) {
    if (!progress) progress = std::make_unique<Progress>(experiment.name, static_cast<long>(all));
    if (done > 0) progress->Set(static_cast<long>(done));
  };
  return RunTrials(experiment, settings);
}

void TellKept(const RunOutcome& outcome, const std::filesystem::path& rows) {
  if (outcome.kept_trials == 0) return;
  fmt::print(stderr, "sextant run: {} of {} trials were already in {}{}\n", outcome.kept_trials,
             outcome.kept_trials + outcome.run_trials, rows.string(),
             outcome.run_trials == 0 ? "; --fresh runs them anew" : "");
}

Expected<void> WriteTiming(const Experiment& experiment, const std::filesystem::path& folder) {
  if (experiment.timed_trials == 0) return {};
  Progress progress("timing",
                    static_cast<long>(experiment.timed_trials * experiment.conditions.size()));
  const std::vector<TimingRow> rows = TimeSubjects(experiment, [&progress] { progress.Step(); });
  if (Expected<void> ok = WriteFileAtomically(folder / "timing.json", FormatTimingJson(rows));
      !ok) {
    return ok;
  }
  return WriteFileAtomically(folder / "timing.md", FormatTimingMarkdown(experiment, rows));
}

// The report, and the tables on standard output.
int Report(const char* command, const ExperimentOptions& options, const Experiment& experiment,
           const std::filesystem::path& rows, const std::filesystem::path& folder) {
  const Expected<std::string> tables =
      WriteReport(experiment, rows, folder, {.csv = !options.no_csv, .plots = true});
  if (!tables) return Refuse(command, tables.error());
  fmt::print("{}{}written to {}\n", *tables, tables->empty() ? "" : "\n", folder.string());
  return kAnswered;
}

}  // namespace

int RunExperiment(const ExperimentOptions& options) {
  const Expected<Experiment> experiment = LoadExperiment(options);
  if (!experiment) return Refuse("run", experiment.error());
  const Expected<Shard> shard = ParseShard(options.shard);
  if (!shard) return Refuse("run", shard.error());
  const Expected<std::filesystem::path> folder = MakeFolder(options, *experiment);
  if (!folder) return Refuse("run", folder.error());
  const bool whole = shard->of == 1;
  const std::filesystem::path rows =
      *folder / (whole ? std::string("rows.sxtrows")
                       : fmt::format("shard_{}_of_{}.sxtrows", shard->number + 1, shard->of));
  const Expected<RunOutcome> outcome = RunWithProgress(
      *experiment,
      {.rows_path = rows, .threads = options.threads, .fresh = options.fresh, .shard = *shard});
  if (!outcome) return Refuse("run", outcome.error());
  TellKept(*outcome, rows);
  if (!whole) {
    fmt::print("written to {}; join the shards with sextant merge\n", rows.string());
    return kAnswered;
  }
  if (Expected<void> ok = WriteTiming(*experiment, *folder); !ok) return Refuse("run", ok.error());
  return Report("run", options, *experiment, rows, *folder);
}

int RunMerge(const ExperimentOptions& options) {
  const Expected<Experiment> experiment = LoadExperiment(options);
  if (!experiment) return Refuse("merge", experiment.error());
  const Expected<std::filesystem::path> folder = MakeFolder(options, *experiment);
  if (!folder) return Refuse("merge", folder.error());
  const std::filesystem::path rows = *folder / "rows.sxtrows";
  const std::vector<std::filesystem::path> shards(options.row_files.begin(),
                                                  options.row_files.end());
  if (Expected<void> ok = MergeRowFiles(shards, rows); !ok) return Refuse("merge", ok.error());
  return Report("merge", options, *experiment, rows, *folder);
}

int RunKinds() {
  fmt::print("{}", FormatKindsPage(BuiltinKinds()));
  return kAnswered;
}

}  // namespace sextant::cli
