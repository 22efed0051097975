// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"
#include "solvers/pnp/correspondences.h"

namespace sextant {

/// The pose that an estimator finds for slightly displaced moments of the image, correct to first
/// order; it must not use the image points themselves.
using PoseOfMoments = std::function<std::optional<Rigid3d>(const ImageMoments&)>;

/// Makes a PoseOfMoments near the solution `near`, from which it may take all that does not change
/// to first order; empty where that is not possible. Refers to `data`.
using MomentsKernel =
    std::function<PoseOfMoments(const Correspondences& data, const Rigid3d& near)>;

/// MomentCovariance by the chain rule, pose by moments by image points, for an estimator that takes
/// the moments: one pass over the points, and 60 calls whose cost does not depend on their number,
/// or 4n calls for 15 points or fewer.
///
/// The derivatives by the moments, or along their derivative by an image coordinate, are central
/// differences with steps that correspond to moving image points by 1e-5; those of the moments by
/// the image points are exact. None where the estimator fails.
std::optional<Matrix6d> ChainedMomentCovariance(const Correspondences& data,
                                                std::span<const Eigen::Matrix2d> image_covariances,
                                                const PoseOfMoments& estimate);

}  // namespace sextant
