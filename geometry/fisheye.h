// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/camera.h"
#include "geometry/lens.h"

namespace sextant {

/// The equidistant fisheye: theta_d (x, y) / r with r^2 = x^2 + y^2, theta = atan2(r, z) from 0 up
/// to pi, theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8). Beyond 90
/// degrees points have z <= 0. None from the angle on at which theta_d stops growing, and for the
/// direction straight back.
std::optional<LensImage> ProjectFisheye(const Camera& camera, const Eigen::Vector3d& point_in_cam);

/// The unit ray of that image, by Newton steps guarded by bisection.
std::optional<Eigen::Vector3d> RayOfFisheye(const Camera& camera, const Eigen::Vector2d& image);

/// theta_d and its derivative by theta; none beyond the angle at which theta_d stops growing.
struct DistortedAngle {
  double value = 0.0;
  double slope = 1.0;
};
std::optional<DistortedAngle> DistortAngle(const Camera& equidistant, double theta);

/// Whether theta_d grows all the way from 0 to `theta` [rad].
bool AngleGrowsUpTo(const Camera& equidistant, double theta);

}  // namespace sextant
