// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/camera.h"

namespace sextant {

/// The image of a point in the camera frame, in focal lengths, and its derivative by the point.
struct LensImage {
  Eigen::Vector2d point;
  Eigen::Matrix<double, 2, 3> by_point;
};

/// The image by the camera's model, before focal lengths, skew and centre:
/// pinhole (x/z, y/z), Brown-Conrady DistortPlane of it, and fisheye.h and sphere_models.h for the
/// wide models. None outside the model's domain.
std::optional<LensImage> ProjectThroughLens(const Camera& camera,
                                            const Eigen::Vector3d& point_in_cam);

/// The unit ray whose image is `image`; none outside the image of the domain.
std::optional<Eigen::Vector3d> RayThroughLens(const Camera& camera, const Eigen::Vector2d& image);

}  // namespace sextant
