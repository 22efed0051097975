// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

namespace sextant {

/// The passes over all points in the algebraic solvers, eight points at a time and summed in the
/// same order on every machine. Each requires at least one point.

Eigen::Vector2d MeanOf(std::span<const Eigen::Vector2d> image_points);
Eigen::Vector3d MeanOf(std::span<const Eigen::Vector3d> points);

/// Mean of (p - centre)(p - centre)^T.
Eigen::Matrix3d ScatterAbout(const Eigen::Vector3d& centre,
                             std::span<const Eigen::Vector3d> points);

/// Sums over i of a h h^T for a = u, v and u^2 + v^2: each the upper triangle of a 4x4 matrix, row
/// by row. h = (1, axes^T (p_i - centroid)), and (u, v) is the image point about its mean.
struct MomentSums {
  std::array<double, 10> u, v, w;
};
MomentSums SumMoments(std::span<const Eigen::Vector2d> image_points, const Eigen::Vector2d& mean,
                      std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& centroid,
                      const Eigen::Matrix3d& axes);

/// How well a pose explains image points (x/z, y/z).
struct ImageFit {
  std::size_t behind = 0;    ///< Points behind the camera.
  double sum_squares = 0.0;  ///< Squared residuals in the image plane, of the points in front.
};
ImageFit FitOf(std::span<const Eigen::Vector2d> image_points,
               std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& rotation,
               const Eigen::Vector3d& translation);

}  // namespace sextant
