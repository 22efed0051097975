// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/camera.h"

namespace sextant {

/// The distorted image of a point of the plane z = 1, both in units of the focal length.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d by_undistorted;  ///< Its derivative; positive determinant.
};

/// With m = (x, y) and s = x^2 + y^2, each model is c(s) m plus the tangential part.
/// Brown-Conrady: c = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3), tangential
/// (2 p1 x y + p2 (s + 2 x^2), p1 (s + 2 y^2) + 2 p2 x y). Equidistant: c = theta_d / sqrt(s),
/// theta = atan(sqrt(s)), theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8).
/// None outside the domain: the disc up to the first radius at which the image stops growing with
/// the radius, and within it wherever the tangential part alone has folded the plane.
std::optional<Distorted> Distort(const Camera& camera, const Eigen::Vector2d& undistorted);

/// theta_d and its derivative by theta; none beyond the angle at which theta_d stops growing.
struct DistortedAngle {
  double value = 0.0;
  double slope = 1.0;
};
std::optional<DistortedAngle> DistortAngle(const Camera& equidistant, double theta);

/// Whether the radial part grows all the way from the axis to `radius`: a radius in the plane
/// z = 1 (Brown-Conrady) or an angle in rad (equidistant).
bool GrowsUpTo(const Camera& camera, double radius);

}  // namespace sextant
