// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/progress.h"
#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// The result of one solver in a comparison.
struct ComparisonRow {
  std::string solver;
  Expected<SolveReport> report;
  /// Distance to the result of the first solver that succeeded.
  std::optional<PoseDistance> from_first;
  std::optional<PoseDistance> from_truth;  ///< Distance to the truth, if it is known.
};

/// Runs every solver on the problem, in the order given; each is a step of the stage "solvers".
std::vector<ComparisonRow> Compare(const CalibrationProblem& problem,
                                   std::span<const SolverPtr> solvers,
                                   const std::optional<Rigid3d>& true_cam_from_lidar,
                                   const ProgressCallback& progress = {});

}  // namespace sextant
