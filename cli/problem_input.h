// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "cli/command.h"
#include "eval/diagnostics/pair_diagnostics.h"
#include "eval/diagnostics/repeated_pairs.h"
#include "eval/diagnostics/rival_groups.h"
#include "eval/metrics/compare.h"
#include "io/problems/problem_yaml.h"
#include "io/results/results_json.h"
#include "solvers/core/registry.h"

// The input and the output that `solve` and `compare` share.
namespace sextant::cli {

struct ProblemInputOptions {
  std::string problem_path{};
  std::string camera_path{};  ///< Empty: the problem's own.
  std::string boards_path{};  ///< Board file or marker_coordinates.txt; empty: the problem's own.
  bool reorder = false;
  std::string json_path{};  ///< See Deliver.
};

/// Help on the files of correspondences.
inline constexpr const char* kCorrespondencesHelp =
    "Correspondences: points.txt of the original package, a problem file (YAML), 3D-3D or 2D-3D\n"
    "pairs (CSV), or poses.csv of cam_lidar_calibration; recognised by their content";

void DeclareProblemInput(ProblemInputOptions& options, Arguments& arguments);

/// The input, ready for the solvers.
struct LoadedProblem {
  ProblemFile file;
  std::vector<RepeatedPairs> repeated;  ///< Pairs that the file lists more than once.
  PairDiagnostics diagnostics;          ///< For the pairs in the file's own order.
  std::optional<RivalGroups> rivals;    ///< In the order that is used; none where boards differ.
  std::vector<std::string> notes;       ///< What was corrected while reading.
  ResultInput summary;
};

/// Reads the problem, adds the camera and the boards that the user names, merges repeated pairs,
/// diagnoses the pairs, and reorders them if requested. Errors: those of the files' readers.
Expected<LoadedProblem> LoadProblem(const ProblemInputOptions& options);

/// Errors: those of SolverRegistry::Make.
Expected<std::vector<SolverPtr>> MakeSolvers(const SolverRegistry& registry,
                                             const std::vector<SpecNode>& specs);

/// Prints why the row's solver has no answer, with the file's name and its repeated pairs, which
/// the solver does not know.
void PrintNoAnswer(const char* command, const ProblemInputOptions& options,
                   const LoadedProblem& input, const ComparisonRow& row);

/// Delivers the text followed by the diagnostics of the data, and of the outliers of a single row;
/// before it the verdict NOT USABLE, with its exit code, where these refute every pose. Returns the
/// exit code.
int DeliverAnswers(const char* command, const ProblemInputOptions& options,
                   const LoadedProblem& input, const std::vector<ComparisonRow>& rows,
                   const std::string& text, bool answered);

}  // namespace sextant::cli
