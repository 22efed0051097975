// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Covariance of each image point (x/z, y/z) that the noise of its pixel causes, to first order:
/// sigma^2 (dm/dpixel)(dm/dpixel)^T by the camera's own model.
///
/// The image points are those of a view that is turned from the camera by `cam_from_view`.
/// `unstated_variance` [px^2] is that of pixels that state no sigma. None where a pixel does not
/// tell the direction (the model's domain ends there).
std::optional<std::vector<Eigen::Matrix2d>> ImageCovariances(
    const Camera& camera, std::span<const Pair2d3d> pairs,
    std::span<const Eigen::Vector2d> image_points, const Eigen::Quaterniond& cam_from_view,
    double unstated_variance);

}  // namespace sextant
