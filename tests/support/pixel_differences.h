// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/core/solver.h"

namespace sextant::test {

/// Covariance of (dphi, dt) by finite differences: every pixel coordinate is displaced to both
/// sides by 1e-5 focal lengths and the problem solved again. Requires stated sigmas. Takes 4 n
/// solves. None if the solution jumps: between two candidates that fit equally well it has no
/// derivative.
std::optional<Matrix6d> CovarianceByPixelDifferences(const Solver& solver,
                                                     const CalibrationProblem& problem,
                                                     const Rigid3d& cam_from_lidar);

/// Largest entry of the difference between two covariances, both whitened by the second.
double WhitenedDifference(const Matrix6d& a, const Matrix6d& b);

}  // namespace sextant::test
