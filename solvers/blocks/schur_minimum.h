// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/problem.h>

#include <span>

namespace sextant {

/// Options of a ceres::Problem whose builder adds every block once, so that Ceres need not check
/// it.
ceres::Problem::Options UncheckedProblem();

struct SchurLimits {
  int max_iterations = 0;
  double step_tolerance = 0.0;      ///< Relative; see ceres::Solver::Options::parameter_tolerance.
  double function_tolerance = 0.0;  ///< Relative change of the cost.
};

struct SchurSteps {
  int count = 0;
  bool converged = false;
};

/// Minimises on one thread. The Schur complement eliminates the blocks `eliminated`, of which no
/// residual has two; `others` are all further blocks. The same bits in every process: the order of
/// the sums is that of the spans.
SchurSteps MinimiseBySchur(ceres::Problem& problem, std::span<double* const> eliminated,
                           std::span<double* const> others, const SchurLimits& limits);

}  // namespace sextant
