// SPDX-License-Identifier: Apache-2.0
#include "solvers/reprojection_covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "solvers/residuals.h"
#include "solvers/subset.h"

namespace sextant {
namespace {

// Degrees of freedom of a pose.
constexpr double kPoseFreedom = 6.0;

double Variance(const Pair2d3d& pair, double unstated) {
  return HasKnownNoise(pair) ? pair.sigma_px * pair.sigma_px : unstated;
}

}  // namespace

std::optional<Eigen::Matrix<double, 2, 6>> ReprojectionJacobian(const Camera& camera,
                                                                const Rigid3d& pose,
                                                                const Pair2d3d& pair) {
  const Eigen::Vector3d arm = pose.rotation * pair.point_in_lidar;
  const auto projection = ProjectWithJacobian(camera, arm + pose.translation);
  if (!projection) return std::nullopt;
  Eigen::Matrix<double, 2, 6> jacobian;
  jacobian << -projection->pixel_by_point * Hat(arm), projection->pixel_by_point;
  return jacobian;
}

std::optional<double> UnstatedVariance(const Camera& camera, std::span<const Pair2d3d> pairs,
                                       const Rigid3d& pose) {
  if (pairs.empty()) return std::nullopt;
  if (HasKnownNoise(pairs.front())) return 0.0;
  const double freedom = 2.0 * static_cast<double>(pairs.size()) - kPoseFreedom;
  if (freedom <= 0.0) return std::nullopt;
  double squares = 0.0;
  for (const Pair2d3d& pair : pairs) {
    const auto residual = ReprojectionResidual(camera, pose, pair);
    if (!residual) return std::nullopt;
    squares += residual->squaredNorm();
  }
  return squares / freedom;
}

std::optional<Matrix6d> ReprojectionCovariance(const Camera& camera,
                                               std::span<const Pair2d3d> pairs,
                                               const Rigid3d& pose) {
  const std::optional<double> unstated = UnstatedVariance(camera, pairs, pose);
  if (!unstated) return std::nullopt;
  Matrix6d information = Matrix6d::Zero();
  for (const Pair2d3d& pair : pairs) {
    const auto jacobian = ReprojectionJacobian(camera, pose, pair);
    if (!jacobian) return std::nullopt;
    // Of unit variance first, where it is common: that of exact data is zero and must not divide.
    information += jacobian->transpose() * *jacobian / Variance(pair, 1.0);
  }
  const Eigen::LDLT<Matrix6d> factor(information);
  if (factor.info() != Eigen::Success || !factor.isPositive() || factor.rcond() < 1e-15) {
    return std::nullopt;
  }
  const double scale = HasKnownNoise(pairs.front()) ? 1.0 : *unstated;
  const Matrix6d covariance = scale * factor.solve(Matrix6d::Identity());
  return Matrix6d(0.5 * (covariance + covariance.transpose()));
}

std::optional<Matrix6d> PropagateByDifferences(const Camera& camera,
                                               std::span<const Pair2d3d> pairs, const Rigid3d& pose,
                                               const PoseOfPairs& estimate) {
  const std::optional<double> unstated = UnstatedVariance(camera, pairs, pose);
  if (!unstated) return std::nullopt;
  // Truncation leaves 1e-10 relative; rounding of the estimate, 1e-13, leaves 1e-8.
  const double step_px = 1e-5 * std::max(camera.fx_px, camera.fy_px);
  std::vector<Pair2d3d> disturbed(pairs.begin(), pairs.end());
  Matrix6d covariance = Matrix6d::Zero();
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    for (int axis = 0; axis < 2; ++axis) {
      disturbed[i].pixel[axis] = pairs[i].pixel[axis] + step_px;
      const std::optional<Rigid3d> ahead = estimate(disturbed);
      disturbed[i].pixel[axis] = pairs[i].pixel[axis] - step_px;
      const std::optional<Rigid3d> behind = estimate(disturbed);
      disturbed[i].pixel[axis] = pairs[i].pixel[axis];
      if (!ahead || !behind) return std::nullopt;
      const Vector6d slope = PoseDifference(*ahead, *behind) / (2.0 * step_px);
      covariance += Variance(pairs[i], *unstated) * slope * slope.transpose();
    }
  }
  return covariance;
}

}  // namespace sextant
