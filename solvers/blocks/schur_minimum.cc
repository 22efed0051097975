// SPDX-License-Identifier: Apache-2.0
#include "solvers/blocks/schur_minimum.h"

#include <ceres/ceres.h>

#include <memory>

namespace sextant {

ceres::Problem::Options UncheckedProblem() {
  ceres::Problem::Options options;
  options.disable_all_safety_checks = true;
  return options;
}

SchurSteps MinimiseBySchur(ceres::Problem& problem, std::span<double* const> eliminated,
                           std::span<double* const> others, const SchurLimits& limits) {
  ceres::Solver::Options options;
  options.max_num_iterations = limits.max_iterations;
  options.parameter_tolerance = limits.step_tolerance;
  options.function_tolerance = limits.function_tolerance;
  options.gradient_tolerance = 0.0;
  options.initial_trust_region_radius = 1e6;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (double* block : eliminated) options.linear_solver_ordering->AddElementToGroup(block, 0);
  // A group for each other block: within one, Ceres orders by address, and sums would depend on it.
  int group = 0;
  for (double* block : others) options.linear_solver_ordering->AddElementToGroup(block, ++group);
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  return {summary.num_successful_steps + summary.num_unsuccessful_steps,
          summary.termination_type == ceres::CONVERGENCE};
}

}  // namespace sextant
