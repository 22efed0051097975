// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>

namespace sextant {

/// What the homography of a plane needs of its points and their image, in one pass.
///
/// A homography sends the plane's coordinates a (unit covariance, zero mean, last entry 1, so that
/// sum a a^T = n I) to image coordinates (h1.a / h3.a, h2.a / h3.a). The algebraic error
/// sum_i |(h3.a) (u, v) - (h1.a, h2.a)|^2 is smallest for h1 = U h3 / n, h2 = V h3 / n, and what is
/// left is h3^T Q h3: a problem of 3 numbers in place of 9. The image coordinates are centred and
/// scaled to unit size as well.
struct PlaneImageMoments {
  double count = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double size = 0.0;                                 ///< Root mean square distance from the centre.
  Eigen::Matrix3d u = Eigen::Matrix3d::Zero();       ///< U = sum u a a^T
  Eigen::Matrix3d v = Eigen::Matrix3d::Zero();       ///< V = sum v a a^T
  Eigen::Matrix3d square = Eigen::Matrix3d::Zero();  ///< sum (u^2 + v^2) a a^T

  /// `image(i)` is (u_i, v_i) and `coordinates(i)` is a_i, for i < points.
  template <class Image, class Coordinates>
  PlaneImageMoments(std::size_t points, const Image& image, const Coordinates& coordinates) {
    count = static_cast<double>(points);
    for (std::size_t i = 0; i < points; ++i) centre += image(i);
    centre /= count;
    for (std::size_t i = 0; i < points; ++i) size += (image(i) - centre).squaredNorm();
    size = std::sqrt(size / count);
    for (std::size_t i = 0; i < points; ++i) {
      const Eigen::Vector2d normalised = (image(i) - centre) / size;
      const Eigen::Vector3d a = coordinates(i);
      const Eigen::Matrix3d outer = a * a.transpose();
      u += normalised.x() * outer;
      v += normalised.y() * outer;
      square += normalised.squaredNorm() * outer;
    }
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
};

}  // namespace sextant
