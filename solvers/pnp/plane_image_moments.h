// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <span>

#include "solvers/kernels/cloud_sums.h"

namespace sextant {

/// The sums over the points of a plane and their image that determine its homography, in one pass.
///
/// A homography sends the plane's coordinates a (unit covariance, zero mean, last entry 1, so that
/// sum a a^T = n I) to image coordinates (h1.a / h3.a, h2.a / h3.a). The algebraic error
/// sum_i |(h3.a) (u, v) - (h1.a, h2.a)|^2 is smallest for h1 = U h3 / n, h2 = V h3 / n, where it is
/// h3^T Q h3: a problem of 3 unknowns instead of 9. The image coordinates are centred and scaled to
/// unit size as well.
struct PlaneImageMoments {
  double count = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double size = 0.0;                                 ///< Root mean square distance from the centre.
  Eigen::Matrix3d u = Eigen::Matrix3d::Zero();       ///< U = sum u a a^T
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();       ///< V = sum v a a^T
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();  ///< sum (u^2 + v^2) a a^T

  /// Shapes: a_i = (unit_from_points (p_i - centroid), 1).
  PlaneImageMoments(std::span<const Eigen::Vector2d> image_points,
                    std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& centroid,
                    const Eigen::Matrix<double, 2, 3>& unit_from_points) {
    count = static_cast<double>(points.size());
    centre = MeanOf(image_points);
    Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
    axes.leftCols<2>() = unit_from_points.transpose();
    const MomentSums sums = SumMoments(image_points, centre, points, centroid, axes);
    size = std::sqrt(sums.w[0] / count);
    u = OnPlane(sums.u) / size;
    v = OnPlane(sums.v) / size;
    square = OnPlane(sums.w) / (size * size);
  }

  /// Q = sum (u^2 + v^2) a a^T - (U^2 + V^2) / n
  Eigen::Matrix3d Reduced() const { return square - (u * u + v * v) / count; }

  /// Rows h1, h2, h3 in image coordinates that are not normalised.
  Eigen::Matrix3d Homography(const Eigen::Vector3d& h3) const {
    Eigen::Matrix3d homography;
    homography.row(0) = (size / count * (u * h3) + centre.x() * h3).transpose();
    homography.row(1) = (size / count * (v * h3) + centre.y() * h3).transpose();
    homography.row(2) = h3.transpose();
    return homography;
  }

 private:
  // Selects the moments of (x, y, 1) from those of (1, x, y, z).
  static Eigen::Matrix3d OnPlane(const std::array<double, 10>& s) {
    Eigen::Matrix3d m;
    m << s[4], s[5], s[1], s[5], s[7], s[2], s[1], s[2], s[0];
    return m;
  }
};

}  // namespace sextant
