// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "cli/commands.h"
#include "eval/experiment/run/run_trials.h"

namespace sextant::cli {

/// What `run`, `merge` and sextant-mpi share.

/// The experiment of the file, as the options change it.
Expected<Experiment> LoadExperiment(const ExperimentOptions& options);

/// The folder that the options name, else results/NAME.
std::filesystem::path FolderOf(const ExperimentOptions& options, const Experiment& experiment);
Expected<void> MakeFolder(const std::filesystem::path& folder);

/// RunTrials with a bar.
Expected<RunOutcome> RunWithProgress(const Experiment& experiment, RunSettings settings);

/// All that is made from the folder's finished rows: the timing, where the experiment asks for it,
/// the report, and its tables on standard output. Returns the exit code.
int WriteAll(const char* command, const ExperimentOptions& options, const Experiment& experiment,
             const std::filesystem::path& folder);
/// The same without the timing.
int WriteTables(const char* command, const ExperimentOptions& options, const Experiment& experiment,
                const std::filesystem::path& folder);

}  // namespace sextant::cli
