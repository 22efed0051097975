// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"
#include "solvers/pnp/correspondences.h"

namespace sextant {

/// The pose that an estimator finds where the moments of the image are a little others, right to
/// first order; it must not look at the image points themselves.
using PoseOfMoments = std::function<std::optional<Rigid3d>(const ImageMoments&)>;

/// That of an estimator near its answer, from which it may take all that does not change to first
/// order; empty where it cannot. Refers to `data`.
using MomentsKernel =
    std::function<PoseOfMoments(const Correspondences& data, const Rigid3d& near)>;

/// MomentCovariance by the chain rule, pose by moments by image points, for an estimator that is
/// given the moments: one pass over the points, and 60 calls that see no point, or 4n where there
/// are 15 points or fewer.
///
/// The derivatives by the moments, or along what an image coordinate does to them, are central
/// differences of what moving image points by 1e-5 would change; those of the moments by the image
/// points are exact. None where the estimator fails.
std::optional<Matrix6d> ChainedMomentCovariance(const Correspondences& data,
                                                std::span<const Eigen::Matrix2d> image_covariances,
                                                const PoseOfMoments& estimate);

}  // namespace sextant
