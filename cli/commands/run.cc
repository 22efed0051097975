// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <charconv>
#include <filesystem>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/experiment_run.h"
#include "cli/output.h"
#include "eval/experiment/run/export_problems.h"
#include "eval/experiment/run/part_files.h"
#include "io/output/output_folder.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

struct RunOptions {
  ExperimentOptions experiment{};
  std::string shard{};          ///< "2/8"; empty: all.
  std::string export_folder{};  ///< Folder for the problems, instead of a run; empty: none.
  GivenOptions given{};
};

void Declare(RunOptions& options, Arguments& arguments) {
  DeclareRun(options.experiment, arguments);
  arguments.Add("--shard", options.shard,
                "I/N: only the I-th of N parts, each for one machine; sextant merge joins them");
  arguments.Add(
      "--export-problems", options.export_folder,
      "Instead of a run, write the problem of each trial for other programs, whose poses\n"
      "come back as the solver imported(\"poses.csv\")",
      {.writes = Writes::kFolder});
  arguments.ReportGiven(options.given);
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
    const std::uint64_t i = number(std::string_view{text}.substr(0, slash));
    const std::uint64_t n = number(std::string_view{text}.substr(slash + 1));
    if (i >= 1 && i <= n) return Shard{.number = i - 1, .of = n};
  }
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("--shard {}: expected I/N with 1 <= I <= N, as 2/8", text));
}

void PrintKept(const RunOutcome& outcome, const std::filesystem::path& rows) {
  for (const std::string& line : outcome.damage) {
    PrintError("sextant run: {}; its trials were run again\n", line);
  }
  if (outcome.kept_trials == 0) return;
  PrintError("sextant run: {} of {} trials were already in {}{}\n", outcome.kept_trials,
             outcome.kept_trials + outcome.run_trials, rows.string(),
             outcome.run_trials == 0 ? "; --fresh runs them again" : "");
}

int Run(const RunOptions& all) {
  const ExperimentOptions& options = all.experiment;
  if (!all.export_folder.empty()) {
    const Expected<void> ok =
        RefuseGiven(all.given, {"--out", "--shard", "--threads", "--fresh", "--no-csv"},
                    "is for a run, which --export-problems replaces");
    if (!ok) return Refuse("run", ok.error());
  }
  const Expected<Experiment> experiment = LoadExperiment(options);
  if (!experiment) return Refuse("run", experiment.error());
  if (!all.export_folder.empty()) {
    const Expected<void> written = ExportProblems(*experiment, all.export_folder);
    if (!written) return Refuse("run", written.error());
    Print("{}", WroteLine(all.export_folder, "problems of " + experiment->name));
    return kAnswered;
  }
  const Expected<Shard> shard = ParseShard(all.shard);
  if (!shard) return Refuse("run", shard.error());
  const std::filesystem::path folder = FolderOf(options, *experiment);
  const bool whole = shard->of == 1;
  const Expected<OutputFolder> locked =
      OutputFolder::Open(folder, whole ? Sharing::kAlone : Sharing::kWithOthers);
  if (!locked) return Refuse("run", locked.error());
  if (const Expected<void> ok =
          whole ? ClaimReport(options, *experiment, folder) : Expected<void>();
      !ok) {
    return Refuse("run", ok.error());
  }
  const std::filesystem::path rows = folder / (whole ? "rows.sxtrows" : PartFileName(*shard));
  const Expected<RunOutcome> outcome = RunWithProgress(
      *experiment,
      {.rows_path = rows, .threads = options.threads, .fresh = options.fresh, .shard = *shard});
  if (!outcome) return Refuse("run", outcome.error());
  PrintKept(*outcome, rows);
  if (whole) return WriteAll("run", options, *experiment, folder);
  Print("{}", WroteLine(rows, "rows of one shard; join the shards with sextant merge"));
  return kAnswered;
}

}  // namespace

Command RunCommand() {
  constexpr const char* kFooter =
      "Writes rows.sxtrows (all measurements), rows.csv, summary.json, report.md, tables.tex and\n"
      "the plots. The same file and seed give the same bytes on any number of threads.\n"
      "Examples:\n"
      "  sextant run experiments/leaderboard.yaml --quick\n"
      "  sextant run experiments/leaderboard.yaml --solvers 'kabsch,my_solver' --out mine\n"
      "  sextant run experiments/accuracy.yaml --shard 2/8 --out /tmp/accuracy";
  return MakeCommand<RunOptions>(
      "run", "An experiment: solvers, conditions and trials of a file, to tables and plots",
      kFooter, Declare, Run);
}

}  // namespace sextant::cli
