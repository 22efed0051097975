// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "solvers/pnp/correspondences.h"

namespace sextant {

/// The cost mean_i |x_i - u_i z_i|^2 + |y_i - v_i z_i|^2 = r^T omega r, with the entries of the
/// rotation (camera from principal axes) row by row in r, and the best centroid for a rotation.
class RotationCost {
 public:
  explicit RotationCost(const Correspondences& data);

  const Eigen::Matrix<double, 9, 9>& omega() const { return omega_; }
  double operator()(const Eigen::Matrix3d& rotation) const;
  Eigen::Vector3d Centroid(const Eigen::Matrix3d& rotation) const;
  /// The nearest minimum by Newton's method: three unknowns with an exact Hessian need no damping.
  Eigen::Matrix3d Minimize(Eigen::Matrix3d rotation) const;

 private:
  Eigen::Matrix<double, 9, 9> omega_;
  Eigen::Matrix<double, 3, 9> centroid_by_rotation_;
};

}  // namespace sextant
