// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Variance [px^2] per axis of pixels without a stated one: sum |r|^2 / (2 n - 6) over the
/// residuals at `pose`; 0 where all pairs state theirs. None where n <= 3 or a point does not
/// project.
std::optional<double> UnstatedVariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                       const Rigid3d& pose);

/// Covariance of (dphi, dt) at the minimum `pose` of the reprojection error:
/// (sum_i J_i^T J_i / sigma_i^2)^-1, the Cramer-Rao bound, J_i (2x6) the derivative of projection i
/// by (dphi, dt). With three pairs, which fit exactly, it holds for any solver. For an algebraic
/// estimator it is a lower bound, not its covariance: see ObjectSpaceCovariance and
/// MomentCovariance.
/// None where a point does not project, there is no variance, or the sum is singular.
std::optional<Matrix6d> ReprojectionCovariance(const Camera& camera,
                                               std::span<const Pair2d3d> pairs,
                                               const Rigid3d& pose);

/// Indices of three pairs that determine a pose.
using Triple = std::array<std::size_t, 3>;

/// Covariance of (dphi, dt) of the pose that projects the points of a triple exactly onto their
/// pixels, in units of the pixel variance where none is stated. None where the triple does not
/// determine the pose.
std::optional<Matrix6d> RelativeTripleCovariance(const Camera& camera,
                                                 std::span<const Pair2d3d> pairs,
                                                 const Triple& triple, const Rigid3d& pose);

/// sum_i J_i^T J_i over all projections [px^2]. An error of the pose of covariance C adds
/// tr(C sum_i J_i^T J_i) to their variance. None where a point does not project.
std::optional<Matrix6d> ProjectionInformation(const Camera& camera, std::span<const Pair2d3d> pairs,
                                              const Rigid3d& pose);

/// RelativeTripleCovariance in absolute units. Pixels without a stated sigma get it from the pairs
/// outside the triple, whose residuals contain the error of the pose besides their own; none where
/// there are no such pairs, or one does not project.
std::optional<Matrix6d> TripleCovariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                         const Triple& triple, const Rigid3d& pose);

}  // namespace sextant
