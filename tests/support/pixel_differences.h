// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/core/solver.h"

namespace sextant::test {

/// Covariance of (dphi, dt) by the definition: every pixel coordinate displaced to both sides by
/// 1e-5 focal lengths, the solver asked each time. Requires stated sigmas. Costs 4 n solves. None
/// where the answer jumps: between two candidates that fit alike it has no derivative.
std::optional<Matrix6d> CovarianceByPixelDifferences(const Solver& solver,
                                                     const CalibrationProblem& problem,
                                                     const Rigid3d& cam_from_lidar);

/// Largest entry of the difference of two covariances, both whitened by the second.
double WhitenedDifference(const Matrix6d& a, const Matrix6d& b);

}  // namespace sextant::test
