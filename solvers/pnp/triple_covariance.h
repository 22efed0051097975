// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Indices of three pairs that fix a pose.
using Triple = std::array<std::size_t, 3>;

/// Covariance of (dphi, dt) of the pose that sees the points of a triple exactly at their pixels:
/// that of the least squares through them, in units of the pixel variance where none is stated.
/// None where the triple does not fix the pose.
std::optional<Matrix6d> RelativeTripleCovariance(const Camera& camera,
                                                 std::span<const Pair2d3d> pairs,
                                                 const Triple& triple, const Rigid3d& pose);

/// sum_i J_i^T J_i over all projections [px^2]. An error of the pose of covariance C adds
/// tr(C sum_i J_i^T J_i) to their variance. None where a point does not project.
std::optional<Matrix6d> ProjectionInformation(const Camera& camera, std::span<const Pair2d3d> pairs,
                                              const Rigid3d& pose);

/// RelativeTripleCovariance in absolute units. Pixels that state no sigma get it from the pairs
/// outside the triple, whose residuals carry the error of the pose besides their own; none where
/// there are no such pairs, or one does not project.
std::optional<Matrix6d> TripleCovariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                         const Triple& triple, const Rigid3d& pose);

}  // namespace sextant
