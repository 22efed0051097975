// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
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
/// estimator it is a lower bound, not its covariance: propagate that with the function below.
/// None where a point does not project, there is no variance, or the sum is singular.
std::optional<Matrix6d> ReprojectionCovariance(const Camera& camera,
                                               std::span<const Pair2d3d> pairs,
                                               const Rigid3d& pose);

/// A closed form: the pose that it finds from the pairs, none where it finds none.
using PoseOfPairs = std::function<std::optional<Rigid3d>(std::span<const Pair2d3d>)>;

/// Covariance of (dphi, dt) of any estimator that is smooth in the pixels, to first order:
/// A Sigma A^T with A (6 x 2n) the derivative of its pose by the pixels, by central differences of
/// 1e-5 focal lengths. `pose` is estimate(pairs). Costs 4 n calls of `estimate`.
/// None where the estimator fails at a disturbed pixel or there is no variance.
std::optional<Matrix6d> PropagateByDifferences(const Camera& camera,
                                               std::span<const Pair2d3d> pairs, const Rigid3d& pose,
                                               const PoseOfPairs& estimate);

}  // namespace sextant
