// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "solvers/pnp/correspondences.h"

namespace sextant {

inline constexpr std::size_t kMaxSqpnpPoses = 4;

/// Minima of the sum of squared distances of the points from their lines of sight, best first.
struct SqpnpFit {
  std::array<Rigid3d, kMaxSqpnpPoses> cam_from_lidar;
  /// sum_i (x_i - u_i z_i)^2 + (y_i - v_i z_i)^2 [m^2], one for each pose.
  std::array<double, kMaxSqpnpPoses> sum_squares{};
  int count = 0;
};

/// The pose that minimises the sum of squares of x - u z and y - v z over the points, by SQPnP
/// (Terzakis and Lourakis 2020, "A consistently fast and globally optimal solution to the
/// perspective-n-point problem").
///
/// The best translation is linear in the rotation r (9 entries), which leaves the minimum of
/// r^T Omega r over rotations. Starts are the rotations nearest to +-sqrt(3) times the eigenvectors
/// of Omega, in ascending order, until an eigenvalue alone costs more than the best found; for a
/// plane Omega is restricted to the first two columns. Two more kinds of start: for flat sets the
/// mirror image of the best pose; for up to five points, and where the best fits badly, the P3P
/// poses of three of them. From each, Newton steps on the rotation (the quadratic programme with
/// its constraints linearised, and with their curvature where that keeps it convex). The other
/// poses of the answer are minima with at most twice the cost of the best; three points have up to
/// four of cost zero.
///
/// Shapes: image points (x/z, y/z), and as many points [m], at least 3; unique from 4 on.
/// Errors: kTooFewPairs; kDegenerate (fewer than 3 different points, on one line, a single ray, or
/// too far away for a translation); kMirrored (a pose with the points behind the camera fits far
/// better, see MirrorRatio); kNoConsensus (no pose in front of the camera fits better than a single
/// image point for all).
Expected<SqpnpFit> SolveSqpnp(std::span<const Eigen::Vector2d> image_points,
                              std::span<const Eigen::Vector3d> points_in_lidar,
                              const PnpChoice& choice = {});

}  // namespace sextant
