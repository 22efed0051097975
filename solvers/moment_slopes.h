// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"
#include "solvers/correspondences.h"

namespace sextant {

/// The pose that an estimator finds where the moments of the image are others, near its answer; it
/// must not look at the image points themselves.
using PoseOfMoments =
    std::function<std::optional<Rigid3d>(const Correspondences& data, const Rigid3d& near)>;

/// MomentCovariance by the chain rule, pose by moments by image points, for an estimator that is
/// given the moments: 60 calls that see no point, and one pass over the points.
///
/// The derivatives by the 30 moments (mean u, v; u, v and u^2 + v^2 times h h^T) are central
/// differences, each of what moving all image points by 1e-5 would change; those of the moments by
/// the image points are exact.
std::optional<Matrix6d> ChainedMomentCovariance(const Correspondences& data,
                                                std::span<const Eigen::Matrix2d> image_covariances,
                                                const PoseOfMoments& estimate, const Rigid3d& pose);

}  // namespace sextant
