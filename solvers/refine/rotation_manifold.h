// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/manifold.h>

namespace sextant {

/// Unit quaternions in Eigen's order (x, y, z, w) with the library's perturbation
/// Plus(q, dphi) = Exp(dphi) q, dphi the full angle [rad] in the outer frame.
///
/// Ceres 2.1's EigenQuaternionManifold uses half angles, so that its covariances would be a quarter
/// of those of this library.
class RotationManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 4; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  /// 4x3, row-major.
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  /// 3x4, row-major: the derivative of Minus(y, x) by y at y = x.
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

}  // namespace sextant
