// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

struct IppeFit {
  std::array<Rigid3d, 2> cam_from_lidar;  ///< Best first.
  /// sum_i |x_i - projection_i|^2 of each on the plane z = 1.
  std::array<double, 2> sum_squares{};
  int count = 0;  ///< 1 where there is no second minimum (strong perspective).
};

/// Both poses of a plane that explain its image: with pixel noise, the tilt of a small or distant
/// board against the line of sight is ambiguous.
///
/// The homography of the plane (linear, plane_image_moments.h) has at the points' centroid a value
/// and a 2x2 Jacobian. Seen along the ray of that value, the Jacobian over depth is the upper left
/// of a rotation, which the orthonormality of its columns completes in two ways (Collins and
/// Bartoli 2014, "Infinitesimal Plane-Based Pose Estimation", IJCV 109). That uses 6 of the
/// homography's 8 parameters, and its square root loses half the digits where the plane faces the
/// ray. Each of the two poses is therefore refined to the nearest minimum of the algebraic error
/// sum_i z_i^2 |x_i - projection_i|^2 over all poses, by Newton steps whose cost does not depend on
/// the number of points. Allocates nothing.
///
/// Shapes: image points (x/z, y/z), and as many points [m] on a plane, anywhere in the LiDAR
/// frame; at least 4 different ones, no three of the four on a line.
/// Errors: kTooFewPairs; kDegenerate (fewer than 4 different points, points on one line, points
/// further off their plane than a tenth of its smaller extent, an image without extent);
/// kMirrored (no pose in front of the camera: the points are behind it or listed the wrong way
/// round).
Expected<IppeFit> SolveIppe(std::span<const Eigen::Vector2d> image_points,
                            std::span<const Eigen::Vector3d> points_in_lidar);

}  // namespace sextant
