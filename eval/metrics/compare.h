// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// One solver's answer beside the others'.
struct ComparisonRow {
  std::string solver;
  Expected<SolveReport> report;
  std::optional<PoseDistance> from_first;  ///< To the first solver that answered.
  std::optional<PoseDistance> from_truth;  ///< Where the truth is known.
};

/// Runs every solver on the problem, in the order given.
std::vector<ComparisonRow> Compare(const CalibrationProblem& problem,
                                   std::span<const SolverPtr> solvers,
                                   const std::optional<Rigid3d>& true_cam_from_lidar);

}  // namespace sextant
