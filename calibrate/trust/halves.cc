// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/halves.h"

#include <algorithm>
#include <cmath>

#include "calibrate/trust/select_views.h"
#include "geometry/symmetric.h"
#include "solvers/joint/normal_of_f.h"

namespace sextant {
namespace {

// The answer of groups [begin, end), with its covariance.
std::optional<SolveReport> SolveGroups(const CalibrationProblem& problem, const Solver& solver,
                                       const std::vector<std::vector<int>>& groups,
                                       std::size_t begin, std::size_t end) {
  std::vector<int> views;
  for (std::size_t i = begin; i < end; ++i) {
    views.insert(views.end(), groups[i].begin(), groups[i].end());
  }
  const Expected<SolveReport> report = solver.Solve(SelectViews(problem, views));
  if (!report || !report->covariance) return std::nullopt;
  return *report;
}

}  // namespace

std::optional<double> HalvesDisagreement(const CalibrationProblem& problem, const Solver& solver,
                                         const std::vector<std::vector<int>>& groups,
                                         double excess) {
  if (groups.size() < std::size_t{kMinViewsForHalves}) return std::nullopt;
  const std::size_t middle = groups.size() / 2;
  const auto first = SolveGroups(problem, solver, groups, 0, middle);
  const auto second = SolveGroups(problem, solver, groups, middle, groups.size());
  if (!first || !second) return std::nullopt;
  const Matrix6d covariance = *first->covariance + *second->covariance;
  const auto information = InvertSymmetric<6>(covariance);
  if (!information) return std::nullopt;
  const Vector6d d = PoseDifference(first->cam_from_lidar, second->cam_from_lidar);
  const double quotient = d.dot(*information * d) / 6.0 / std::max(1.0, excess);
  const double quantile = NormalOfF(quotient, 6.0, 2.0 * static_cast<double>(groups.size()));
  if (!std::isfinite(quantile)) return std::nullopt;
  return quantile;
}

}  // namespace sextant
