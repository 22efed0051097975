// SPDX-License-Identifier: Apache-2.0
#include "geometry/pair_noise.h"

#include "geometry/residuals.h"
#include "geometry/symmetric.h"

namespace sextant {

Eigen::Matrix3d StatedCovariance(const Pair3d3d& pair) {
  if (pair.covariance_in_cam) return *pair.covariance_in_cam;
  const double sigma = pair.sigma_m > 0.0 ? pair.sigma_m : 1.0;
  return Eigen::Matrix3d::Identity() * (sigma * sigma);
}

std::vector<double> IsotropicWeights(std::span<const Pair3d3d> pairs) {
  std::vector<double> weights;
  weights.reserve(pairs.size());
  for (const Pair3d3d& pair : pairs) weights.push_back(IsotropicWeight(pair));
  return weights;
}

std::optional<Matrix6d> PropagateCovariance(std::span<const Pair3d3d> pairs,
                                            std::span<const double> weights, const Rigid3d& pose) {
  const bool noise_known = !pairs.empty() && HasKnownNoise(pairs.front());
  Matrix6d hessian = Matrix6d::Zero();
  Matrix6d noise = Matrix6d::Zero();
  double weighted_squares = 0.0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d arm = pose.rotation * pairs[i].point_in_lidar;
    const Eigen::Vector3d residual = PointResidual(pose, pairs[i]);
    const double w = weights[i];
    // r(dphi, dt) = r - dphi x arm - dt, to first order.
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << Hat(arm), -Eigen::Matrix3d::Identity();
    hessian += w * jacobian.transpose() * jacobian;
    // Second order of Exp(dphi) arm: the curvature contributed by a large residual.
    const Eigen::Matrix3d outer = residual * arm.transpose();
    hessian.topLeftCorner<3, 3>() +=
        w * (residual.dot(arm) * Eigen::Matrix3d::Identity() - 0.5 * (outer + outer.transpose()));
    const Eigen::Matrix3d sigma =
        noise_known ? StatedCovariance(pairs[i]) : Eigen::Matrix3d(Eigen::Matrix3d::Identity() / w);
    noise += w * w * jacobian.transpose() * sigma * jacobian;
    weighted_squares += w * residual.squaredNorm();
  }
  if (!noise_known) {
    const double freedom = 3.0 * static_cast<double>(pairs.size()) - 6.0;
    if (freedom <= 0.0) return std::nullopt;
    noise *= weighted_squares / freedom;
  }
  const std::optional<Matrix6d> inverse = InvertSymmetric(hessian);
  if (!inverse) return std::nullopt;
  const Matrix6d covariance = *inverse * noise * *inverse;
  return Matrix6d(0.5 * (covariance + covariance.transpose()));
}

}  // namespace sextant
