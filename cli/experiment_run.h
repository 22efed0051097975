// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "cli/command.h"
#include "eval/experiment/run/run_trials.h"

// What `run`, `merge` and `sextant-mpi run` share.
namespace sextant::cli {

struct ExperimentOptions {
  std::string experiment_path{};
  std::string out{};         ///< Folder; empty: results/NAME.
  std::string solvers{};     ///< Empty: the file's.
  int threads = 0;           ///< 0: all.
  std::uint64_t trials = 0;  ///< 0: the number in the file.
  std::optional<std::uint64_t> seed{};
  bool quick = false;
  bool fresh = false;
  bool no_csv = false;
  bool allow_commands = false;
};

/// Which experiment is run or merged, and the folder of its results.
void DeclareExperiment(ExperimentOptions& options, Arguments& arguments);
/// The same, and how it is run, by one process or by MPI ranks.
void DeclareRun(ExperimentOptions& options, Arguments& arguments);

/// The experiment of the file, modified by the options. Errors: those of ReadExperiment.
Expected<Experiment> LoadExperiment(const ExperimentOptions& options);

/// The folder that the options name, else results/NAME.
std::filesystem::path FolderOf(const ExperimentOptions& options, const Experiment& experiment);

/// Checks before any trial that the files of the report can be written into the folder. Errors:
/// those of ClaimOutput.
Expected<void> ClaimReport(const ExperimentOptions& options, const Experiment& experiment,
                           const std::filesystem::path& folder);

/// RunTrials with a progress bar.
Expected<RunOutcome> RunWithProgress(const Experiment& experiment, RunSettings settings);

/// Everything that is made from the finished rows in the folder: the timing, if the experiment has
/// one, the report, and its tables on standard output. Returns the exit code.
int WriteAll(const char* command, const ExperimentOptions& options, const Experiment& experiment,
             const std::filesystem::path& folder);
/// The same without the timing.
int WriteTables(const char* command, const ExperimentOptions& options, const Experiment& experiment,
                const std::filesystem::path& folder);

}  // namespace sextant::cli
