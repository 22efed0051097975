// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstddef>

namespace sextant {

/// What linear projection models need of image points and their objects, in one pass.
///
/// A linear model sends the coordinates a (unit covariance, zero mean, last entry 1, so that
/// sum a a^T = n I) to image coordinates (h1.a / h3.a, h2.a / h3.a). The algebraic error
/// sum_i |(h3.a) (u, v) - (h1.a, h2.a)|^2 is smallest for h1 = U h3 / n, h2 = V h3 / n, and what is
/// left is h3^T Q h3: a problem of 3 numbers for a plane and 4 for space in place of 9 and 12. The
/// image coordinates are centred and scaled to unit size as well.
template <int kSize>
struct ImageMoments {
  using Square = Eigen::Matrix<double, kSize, kSize>;
  using Vector = Eigen::Matrix<double, kSize, 1>;

  double count = 0.0;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double size = 0.0;               ///< Root mean square distance from the centre.
  Square u = Square::Zero();       ///< U = sum u a a^T
  Square v = Square::Zero();       ///< V = sum v a a^T
  Square square = Square::Zero();  ///< sum (u^2 + v^2) a a^T

  /// `image(i)` is (u_i, v_i) and `coordinates(i)` is a_i, for i < points.
  template <class Image, class Coordinates>
  ImageMoments(std::size_t points, const Image& image, const Coordinates& coordinates) {
    count = static_cast<double>(points);
    for (std::size_t i = 0; i < points; ++i) centre += image(i);
    centre /= count;
    for (std::size_t i = 0; i < points; ++i) size += (image(i) - centre).squaredNorm();
    size = std::sqrt(size / count);
    for (std::size_t i = 0; i < points; ++i) {
      const Eigen::Vector2d normalised = (image(i) - centre) / size;
      const Vector a = coordinates(i);
      const Square outer = a * a.transpose();
      u += normalised.x() * outer;
      v += normalised.y() * outer;
      square += normalised.squaredNorm() * outer;
    }
  }

  /// Q = sum (u^2 + v^2) a a^T - (U^2 + V^2) / n
  Square Reduced() const { return square - (u * u + v * v) / count; }

  /// Rows h1, h2, h3 in image coordinates that are not normalised.
  Eigen::Matrix<double, 3, kSize> Model(const Vector& h3) const {
    Eigen::Matrix<double, 3, kSize> model;
    model.row(0) = (size / count * (u * h3) + centre.x() * h3).transpose();
    model.row(1) = (size / count * (v * h3) + centre.y() * h3).transpose();
    model.row(2) = h3.transpose();
    return model;
  }
};

}  // namespace sextant
