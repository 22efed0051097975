// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/camera.h"

namespace sextant {

/// The distorted image of a point of a plane, both in units of the focal length.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d by_undistorted;  ///< Its derivative; positive determinant.
};

/// Brown-Conrady: with m = (x, y) and s = x^2 + y^2, c(s) m plus the tangential and the prism's
/// part: c = (1 + k1 s + k2 s^2 + k3 s^3) / (1 + k4 s + k5 s^2 + k6 s^3), tangential
/// (2 p1 x y + p2 (s + 2 x^2), p1 (s + 2 y^2) + 2 p2 x y), prism (s1 s + s2 s^2, s3 s + s4 s^2).
/// A sensor tilted by tau_x and tau_y then sees the point by the homography
/// [R33 0 -R13; 0 R33 -R23; 0 0 1] R with R = Ry(tau_y) Rx(tau_x), as OpenCV defines them.
/// None outside the domain: the disc up to the first radius at which the image stops growing with
/// the radius, or grows ten times as fast as at the centre, which happens close to a pole of the
/// rational part, and within it wherever the other parts have folded the plane. Works on the
/// coefficients alone, whatever the model: the omnidirectional model uses it too.
std::optional<Distorted> DistortPlane(const Camera& camera, const Eigen::Vector2d& undistorted);

/// The homography of a tilted sensor; see DistortPlane.
Eigen::Matrix3d TiltHomography(double tau_x, double tau_y);

/// The point whose distorted image is `distorted`, to rounding; none outside the domain's image.
std::optional<Eigen::Vector2d> UndistortPlane(const Camera& camera,
                                              const Eigen::Vector2d& distorted);

/// The image of a point of the plane z = 1 by any model.
std::optional<Distorted> Distort(const Camera& camera, const Eigen::Vector2d& undistorted);

/// Whether the radial part grows all the way from the axis to `radius`: a radius in the plane that
/// is distorted.
bool PlaneGrowsUpTo(const Camera& camera, double radius);

/// Whether the denominator 1 + k4 s + k5 s^2 + k6 s^3 is positive up to `radius`.
bool HasNoPoleUpTo(const Camera& camera, double radius);

}  // namespace sextant
