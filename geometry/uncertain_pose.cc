// SPDX-License-Identifier: Apache-2.0
#include "geometry/uncertain_pose.h"

namespace sextant {

// (Exp(d) R) q + t + dt moves by -[R q]x d + dt where the left factor is perturbed; for the right
// one, R Exp(d) R_q = Exp(R d) R R_q, and its translation is rotated by R.
ProductJacobians JacobiansOfProduct(const Rigid3d& b_from_a, const Rigid3d& a_from_c) {
  const Eigen::Matrix3d rotation = b_from_a.rotation.toRotationMatrix();
  ProductJacobians jacobians;
  jacobians.by_left.bottomLeftCorner<3, 3>() = -Hat(rotation * a_from_c.translation);
  jacobians.by_right.topLeftCorner<3, 3>() = rotation;
  jacobians.by_right.bottomRightCorner<3, 3>() = rotation;
  return jacobians;
}

Matrix6d JacobianOfInverse(const Rigid3d& b_from_a) {
  const Eigen::Matrix3d inverse = b_from_a.rotation.conjugate().toRotationMatrix();
  Matrix6d jacobian = Matrix6d::Zero();
  jacobian.topLeftCorner<3, 3>() = -inverse;
  jacobian.bottomRightCorner<3, 3>() = -inverse;
  jacobian.bottomLeftCorner<3, 3>() = -inverse * Hat(b_from_a.translation);
  return jacobian;
}

UncertainPose Chain(const UncertainPose& c_from_b, const UncertainPose& b_from_a) {
  const ProductJacobians by = JacobiansOfProduct(c_from_b.b_from_a, b_from_a.b_from_a);
  return {.b_from_a = c_from_b.b_from_a * b_from_a.b_from_a,
          .covariance = by.by_left * c_from_b.covariance * by.by_left.transpose() +
                        by.by_right * b_from_a.covariance * by.by_right.transpose()};
}

UncertainPose Inverse(const UncertainPose& b_from_a) {
  const Matrix6d jacobian = JacobianOfInverse(b_from_a.b_from_a);
  return {.b_from_a = b_from_a.b_from_a.Inverse(),
          .covariance = jacobian * b_from_a.covariance * jacobian.transpose()};
}

}  // namespace sextant
