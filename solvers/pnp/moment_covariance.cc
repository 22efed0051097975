// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/moment_covariance.h"

#include <Eigen/QR>
#include <numeric>
#include <vector>

namespace sextant {
namespace {

constexpr Eigen::Index kMoments = 30;

/// An orthonormal basis, in columns, of the displacements of image points that change the moments;
/// rows are u_0, v_0, u_1, v_1 and so on.
Eigen::MatrixXd Displacements(std::span<const Eigen::Vector2d> image_points,
                              std::span<const Eigen::Vector3d> points) {
  const auto rows = static_cast<Eigen::Index>(2 * points.size());
  if (rows <= kMoments) return Eigen::MatrixXd::Identity(rows, rows);
  const auto count = static_cast<double>(points.size());
  // Moments about the means are linear combinations of the others, and better scaled.
  const Eigen::Vector3d centroid =
      std::accumulate(points.begin(), points.end(), Eigen::Vector3d(Eigen::Vector3d::Zero())) /
      count;
  const Eigen::Vector2d centre = std::accumulate(image_points.begin(), image_points.end(),
                                                 Eigen::Vector2d(Eigen::Vector2d::Zero())) /
                                 count;
  Eigen::MatrixXd slopes = Eigen::MatrixXd::Zero(rows, kMoments);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector4d h = (points[i] - centroid).homogeneous();
    const Eigen::Vector2d uv = image_points[i] - centre;
    const auto row = static_cast<Eigen::Index>(2 * i);
    Eigen::Index column = 0;
    for (int j = 0; j < 4; ++j) {
      for (int k = j; k < 4; ++k, column += 3) {
        const double product = h(j) * h(k);
        slopes(row, column) = product;
        slopes(row + 1, column + 1) = product;
        slopes(row, column + 2) = uv.x() * product;
        slopes(row + 1, column + 2) = uv.y() * product;
      }
    }
  }
  // Where moments are dependent, as on a plane, the basis has superfluous vectors, which do no
  // harm.
  const Eigen::HouseholderQR<Eigen::Ref<Eigen::MatrixXd>> factor(slopes);
  return factor.householderQ() * Eigen::MatrixXd::Identity(rows, kMoments);
}

}  // namespace

std::optional<Matrix6d> MomentCovariance(std::span<const Eigen::Vector2d> image_points,
                                         std::span<const Eigen::Matrix2d> image_covariances,
                                         std::span<const Eigen::Vector3d> points,
                                         const PoseOfImage& estimate) {
  // The truncation error is 1e-10 relative; rounding of the estimate, 1e-13, adds 1e-8.
  constexpr double kLargestDisplacement = 1e-5;
  const Eigen::MatrixXd basis = Displacements(image_points, points);
  Eigen::Matrix<double, 6, Eigen::Dynamic> slopes(6, basis.cols());
  std::vector<Eigen::Vector2d> displaced(image_points.size());
  const auto estimate_at = [&](Eigen::Index column, double step) {
    for (std::size_t i = 0; i < displaced.size(); ++i) {
      displaced[i] =
          image_points[i] + step * basis.block<2, 1>(static_cast<Eigen::Index>(2 * i), column);
    }
    return estimate(displaced);
  };
  for (Eigen::Index column = 0; column < basis.cols(); ++column) {
    const double step = kLargestDisplacement / basis.col(column).cwiseAbs().maxCoeff();
    const std::optional<Rigid3d> ahead = estimate_at(column, step);
    const std::optional<Rigid3d> behind = estimate_at(column, -step);
    if (!ahead || !behind) return std::nullopt;
    slopes.col(column) = PoseDifference(*ahead, *behind) / (2.0 * step);
  }
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Matrix<double, 6, 2> by_image =
        slopes * basis.middleRows<2>(static_cast<Eigen::Index>(2 * i)).transpose();
    covariance += by_image * image_covariances[i] * by_image.transpose();
  }
  return Matrix6d(0.5 * (covariance + covariance.transpose()));
}

}  // namespace sextant
