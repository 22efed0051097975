// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/error.h"
#include "solvers/pnp/point_cloud_frame.h"

namespace sextant {

/// Sufficient statistics of the linear equations x - u z = y - v z = 0 of a point set of any size.
///
/// With h_i = (1, coordinates of point i about the centroid along the principal axes [m]) and the
/// image point (u_i, v_i) about the mean image point, the means over i of u h h^T, v h h^T and
/// (u^2 + v^2) h h^T.
struct ImageMoments {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();  ///< Mean of the image points.
  Eigen::Matrix4d u;
  Eigen::Matrix4d v;
  Eigen::Matrix4d w;

  /// Mean square distance of the image points from their mean.
  double Spread() const { return w(0, 0); }
};

/// Error: kDegenerate where all image points coincide.
Expected<ImageMoments> ComputeImageMoments(std::span<const Eigen::Vector2d> image_points,
                                           std::span<const Eigen::Vector3d> points,
                                           const PointCloudFrame& frame);

}  // namespace sextant
