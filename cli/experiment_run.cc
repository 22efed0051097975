// SPDX-License-Identifier: Apache-2.0
#include "cli/experiment_run.h"

#include <system_error>
#include <vector>

#include "base/text/path_text.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "eval/experiment/definition/timing.h"
#include "eval/experiment/report/write_report.h"
#include "io/output/output_file.h"
#include "io/output/standard_output.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

constexpr const char* kTimingJson = "timing.json";
constexpr const char* kTimingPage = "timing.md";

ReportSettings ReportSettingsOf(const ExperimentOptions& options) {
  return {.csv = !options.no_csv, .plots = true, .timing = {}};
}

Expected<std::vector<TimingRow>> WriteTiming(const Experiment& experiment,
                                             const std::filesystem::path& folder) {
  if (experiment.timed_trials == 0) return std::vector<TimingRow>();
  Progress progress;
  ProgressCounter counter(progress.Callback(), "timing",
                          experiment.timed_trials * experiment.conditions.size());
  std::vector<TimingRow> rows = TimeSubjects(experiment, [&counter] { counter.Step(); });
  counter.Finish();
  SEXTANT_RETURN_IF_ERROR(WriteFileAtomically(folder / kTimingJson, FormatTimingJson(rows)));
  SEXTANT_RETURN_IF_ERROR(
      WriteFileAtomically(folder / kTimingPage, FormatTimingMarkdown(experiment, rows)));
  return rows;
}

int WriteTablesWith(const char* command, const ReportSettings& settings,
                    const Experiment& experiment, const std::filesystem::path& folder) {
  const std::filesystem::path csv = folder / "rows.csv";
  std::error_code ignored;
  const bool had_csv = !settings.csv && std::filesystem::exists(csv, ignored);
  const Expected<std::string> tables =
      WriteReport(experiment, folder / "rows.sxtrows", folder, settings);
  if (!tables) return Refuse(command, tables.error());
  if (had_csv && std::filesystem::exists(csv, ignored)) {
    PrintError(
        "sextant {}: note: {} is not of this run, which wrote none; sextant did not write it, or "
        "it was changed, so it was left there\n",
        command, PathText(csv));
  } else if (had_csv) {
    PrintError("sextant {}: {} of an earlier run was removed, because --no-csv writes no new one\n",
               command, PathText(csv));
  }
  Print("{}{}{}", *tables, tables->empty() ? "" : "\n",
        WroteLine(folder, "rows, tables and plots of " + experiment.name));
  return kAnswered;
}

}  // namespace

void DeclareExperiment(ExperimentOptions& options, Arguments& arguments) {
  arguments.Add("EXPERIMENT", options.experiment_path, "Experiment file (YAML)",
                {.required = true});
  arguments.Add("--out", options.out,
                "Folder to write; a run that was stopped continues where it was.\n"
                "Default: results/NAME",
                {.writes = Writes::kFolder});
  arguments.Add("--solvers", options.solvers,
                "Instead of the file's, separated by commas; conditions without data for them are\n"
                "skipped");
  arguments.Add("--trials", options.trials, "Instead of the file's", {.range = {{1, 1e9}}});
  arguments.Add("--seed", options.seed, "Instead of the file's");
  arguments.Add("--quick", options.quick, "The file's quick_trials instead of its trials");
  arguments.Add("--allow-commands", options.allow_commands,
                "Let the file's command(...) solvers run the programs that they name");
  arguments.Add("--no-csv", options.no_csv, "Without rows.csv, which is large for many trials");
}

void DeclareRun(ExperimentOptions& options, Arguments& arguments) {
  DeclareExperiment(options, arguments);
  arguments.Add("--threads", options.threads,
                "Default: as many as the machine has; an MPI rank takes its share of them",
                {.range = {{1, 1024}}});
  arguments.Add("--fresh", options.fresh, "Delete existing rows first");
}

Expected<Experiment> LoadExperiment(const ExperimentOptions& options) {
  Expected<Experiment> experiment =
      ReadExperiment(options.experiment_path, BuiltinKinds(),
                     AllSolvers(options.allow_commands ? Commands::kAllowed : Commands::kRefused),
                     options.solvers);
  if (!experiment) return experiment;
  if (options.quick) experiment->trials = experiment->quick_trials;
  if (options.trials > 0) experiment->trials = options.trials;
  if (options.seed) experiment->seed = *options.seed;
  return experiment;
}

std::filesystem::path FolderOf(const ExperimentOptions& options, const Experiment& experiment) {
  if (!options.out.empty()) return options.out;
  return std::filesystem::path("results") / (experiment.name + (options.quick ? "-quick" : ""));
}

Expected<void> ClaimReport(const ExperimentOptions& options, const Experiment& experiment,
                           const std::filesystem::path& folder) {
  std::vector<std::string> timing;
  if (experiment.timed_trials > 0) timing = {kTimingJson, kTimingPage};
  return ClaimReportFiles(experiment, folder, ReportSettingsOf(options), timing);
}

Expected<RunOutcome> RunWithProgress(const Experiment& experiment, RunSettings settings) {
  Progress progress;
  settings.after_block = [&](std::uint64_t done, std::uint64_t all) {
    progress.Report(experiment.name, done, all);
  };
  return RunTrials(experiment, settings);
}

int WriteAll(const char* command, const ExperimentOptions& options, const Experiment& experiment,
             const std::filesystem::path& folder) {
  Expected<std::vector<TimingRow>> timing = WriteTiming(experiment, folder);
  if (!timing) return Refuse(command, timing.error());
  ReportSettings settings = ReportSettingsOf(options);
  settings.timing = std::move(*timing);
  return WriteTablesWith(command, settings, experiment, folder);
}

int WriteTables(const char* command, const ExperimentOptions& options, const Experiment& experiment,
                const std::filesystem::path& folder) {
  return WriteTablesWith(command, ReportSettingsOf(options), experiment, folder);
}

}  // namespace sextant::cli
