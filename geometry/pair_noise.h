// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// The covariance that a pair states; the identity where it states none.
Eigen::Matrix3d StatedCovariance(const Pair3d3d& pair);

/// 1 / (mean variance per axis) of a pair; 1 where it states no noise.
inline double IsotropicWeight(const Pair3d3d& pair) {
  if (pair.covariance_in_cam) return 3.0 / pair.covariance_in_cam->trace();
  return pair.sigma_m > 0.0 ? 1.0 / (pair.sigma_m * pair.sigma_m) : 1.0;
}
std::vector<double> IsotropicWeights(std::span<const Pair3d3d> pairs);

/// Covariance of (dphi, dt) of the minimum of sum_i w_i |q_i - R p_i - t|^2 at `pose`.
///
/// Implicit function theorem: with H the Hessian of the cost and J_i the Jacobian of residual i,
/// cov = H^-1 (sum_i w_i^2 J_i^T Sigma_i J_i) H^-1. Sigma_i is the stated covariance; where
/// none is stated it is the residual variance sum w r^2 / (3 n - 6) times 1/w_i, and there is no
/// covariance for n < 3. Shapes: weights has the size of pairs. Source: Haralick 1998,
/// "Propagating covariance in computer vision".
/// None where H is singular.
std::optional<Matrix6d> PropagateCovariance(std::span<const Pair3d3d> pairs,
                                            std::span<const double> weights, const Rigid3d& pose);

}  // namespace sextant
