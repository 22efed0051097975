// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"
#include "io/results/results_json.h"
#include "solvers/core/solver.h"

namespace sextant::python {

/// sextant.Problem: the data that solvers see, and what they must not see.
struct ModuleProblem {
  std::shared_ptr<const CalibrationProblem> data;
  std::optional<Rigid3d> true_cam_from_lidar{};
  ResultInput input{};               ///< Its path is empty for a problem of arrays.
  std::vector<std::string> notes{};  ///< What the reader corrected.
};

/// sextant.Solution: the answer of a solver, with the problem that it answers.
struct ModuleSolution {
  ModuleProblem problem;
  SolverPtr solver;
  SolveReport report;
};

}  // namespace sextant::python
