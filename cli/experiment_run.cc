// SPDX-License-Identifier: Apache-2.0
#include "cli/experiment_run.h"

#include <fmt/core.h>

#include <memory>
#include <system_error>

#include "cli/catalogue.h"
#include "cli/load.h"
#include "cli/progress.h"
#include "eval/experiment/definition/timing.h"
#include "eval/experiment/report/write_report.h"
#include "io/text/text_file.h"

namespace sextant::cli {
namespace {

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

}  // namespace

Expected<Experiment> LoadExperiment(const ExperimentOptions& options) {
  Expected<Experiment> experiment =
      ReadExperiment(options.experiment_path, BuiltinKinds(), AllSolvers(), options.solvers);
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

Expected<void> MakeFolder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error && std::filesystem::is_directory(folder, error)) return {};
  return MakeError(ErrorCode::kIo, fmt::format("cannot make the folder '{}': {}; name another "
                                               "with --out",
                                               folder.string(), error.message()));
}

Expected<RunOutcome> RunWithProgress(const Experiment& experiment, RunSettings settings) {
  std::unique_ptr<Progress> progress;
  settings.after_block = [&](std::uint64_t done, std::uint64_t all) {
    if (!progress) progress = std::make_unique<Progress>(experiment.name, static_cast<long>(all));
    if (done > 0) progress->Set(static_cast<long>(done));
  };
  return RunTrials(experiment, settings);
}

int WriteAll(const char* command, const ExperimentOptions& options, const Experiment& experiment,
             const std::filesystem::path& folder) {
  if (Expected<void> ok = WriteTiming(experiment, folder); !ok) return Refuse(command, ok.error());
  return WriteTables(command, options, experiment, folder);
}

int WriteTables(const char* command, const ExperimentOptions& options, const Experiment& experiment,
                const std::filesystem::path& folder) {
  const Expected<std::string> tables = WriteReport(experiment, folder / "rows.sxtrows", folder,
                                                   {.csv = !options.no_csv, .plots = true});
  if (!tables) return Refuse(command, tables.error());
  fmt::print("{}{}written to {}\n", *tables, tables->empty() ? "" : "\n", folder.string());
  return kAnswered;
}

}  // namespace sextant::cli
