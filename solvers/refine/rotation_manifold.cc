// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/rotation_manifold.h"

#include <Eigen/Geometry>

#include "geometry/so3.h"

namespace sextant {
namespace {

using ConstQuaternion = Eigen::Map<const Eigen::Quaterniond>;

// Twice the derivative of (dphi / 2, 0) * q by dphi, vector part first: see PlusJacobian.
Eigen::Matrix<double, 4, 3> HalfTurns(const ConstQuaternion& q) {
  Eigen::Matrix<double, 4, 3> m;
  m.topRows<3>() = q.w() * Eigen::Matrix3d::Identity() - Hat(q.vec());
  m.bottomRows<1>() = -q.vec().transpose();
  return m;
}

}  // namespace

bool RotationManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  const Eigen::Quaterniond sum =
      ExpSo3(Eigen::Map<const Eigen::Vector3d>(delta)) * ConstQuaternion(x);
  Eigen::Map<Eigen::Quaterniond> result(x_plus_delta);
  result = sum.normalized();
  return true;
}

bool RotationManifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 4, 3, Eigen::RowMajor>> m(jacobian);
  m = 0.5 * HalfTurns(ConstQuaternion(x));
  return true;
}

bool RotationManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Eigen::Vector3d> difference(y_minus_x);
  difference = LogSo3(ConstQuaternion(y) * ConstQuaternion(x).conjugate());
  return true;
}

bool RotationManifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> m(jacobian);
  m = 2.0 * HalfTurns(ConstQuaternion(x)).transpose();
  return true;
}

}  // namespace sextant
