// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Derivative of a pair's projection [px] by (dphi, dt) of the pose; none where it does not
/// project.
std::optional<Eigen::Matrix<double, 2, 6>> ReprojectionJacobian(const Camera& camera,
                                                                const Rigid3d& pose,
                                                                const Pair2d3d& pair);

/// Variance [px^2] per axis of pixels that state none: sum |r|^2 / (2 n - 6) over the residuals at
/// `pose`; 0 where all pairs state theirs. None where n <= 3 or a point does not project.
std::optional<double> UnstatedVariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                       const Rigid3d& pose);

/// Covariance of (dphi, dt) of the least squares of reprojection at its minimum `pose`:
/// (sum_i J_i^T J_i / sigma_i^2)^-1, the Cramer-Rao bound, J_i (2x6) the derivative of projection i
/// by (dphi, dt). With three pairs, which fit exactly, it holds for any solver. For an algebraic
/// estimator it is a lower bound, not its covariance: see ObjectSpaceCovariance and
/// MomentCovariance.
/// None where a point does not project, there is no variance, or the sum is singular.
std::optional<Matrix6d> ReprojectionCovariance(const Camera& camera,
                                               std::span<const Pair2d3d> pairs,
                                               const Rigid3d& pose);

}  // namespace sextant
