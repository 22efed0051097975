// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "eval/experiment/definition/experiment.h"

namespace sextant {

/// Writes the problem of each trial, as solvers see it, for programs that cannot be a solver here:
/// FOLDER/NNN/TRIAL.yaml (problem files, without the truth; NNN counts the conditions), and
/// FOLDER/problems.csv with the columns condition, trial and file. Poses for these come back as
/// imported("poses.csv"). Errors: kInvalidInput for a kind whose trials have no problem, or one
/// that draws none; those of the output files.
Expected<void> ExportProblems(const Experiment& experiment, const std::filesystem::path& folder);

}  // namespace sextant
