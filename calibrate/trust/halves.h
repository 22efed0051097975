// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// How far the answers of the first and of the second half of the groups of views differ, as a
/// quantile of the standard normal distribution. With d = PoseDifference and C the sum of both
/// covariances, d^T C^-1 d / 6 over `excess`, the squared scatter of the views over their noise
/// where that is above 1, is taken as F-distributed with 6 and twice as many degrees of freedom as
/// there are groups.
///
/// A sensor that moved between the views differs between the halves, while each half agrees within
/// itself, so that no single view contradicts the others. A move far from the middle shows less.
/// Errors that both halves share cancel, so that the figure is cautious.
///
/// `groups`: views that share their errors, in the order of recording. None for fewer than
/// kMinViewsForHalves groups, without an answer or a covariance of either half. Time: two solutions
/// of half the size.
std::optional<double> HalvesDisagreement(const CalibrationProblem& problem, const Solver& solver,
                                         const std::vector<std::vector<int>>& groups,
                                         double excess);

inline constexpr int kMinViewsForHalves = 4;

}  // namespace sextant
