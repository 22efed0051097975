// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/manifold.h>

#include <Eigen/Core>

#include "geometry/rigid3d.h"

namespace sextant {

/// Poses as one parameter block of 7 numbers each: the quaternion (x, y, z, w), the translation.
inline constexpr int kPoseNumbers = 7;

inline Rigid3d PoseIn(const double* numbers) {
  return {Eigen::Quaterniond(numbers), Eigen::Map<const Eigen::Vector3d>(numbers + 4)};
}
inline void StorePose(const Rigid3d& pose, double* numbers) {
  Eigen::Map<Eigen::Matrix<double, kPoseNumbers, 1>> all(numbers);
  all << pose.rotation.coeffs(), pose.translation;
}

/// `poses` poses with the library's perturbation (Perturb), as one parameter block.
///
/// Ceres multiplies a cost's derivative by the 7 numbers of a pose with PlusJacobian, and uses
/// neither otherwise. Here PlusJacobian is (I, 0), so that the first six columns of each pose (all
/// rotations and translations of the block first) are the derivative by its (dphi, dt): the costs
/// of joint and rig write that derivative into the first 6 columns a pose and 0 into the others.
class PoseManifold final : public ceres::Manifold {
 public:
  explicit PoseManifold(int poses) : poses_(poses) {}

  int AmbientSize() const override { return kPoseNumbers * poses_; }
  int TangentSize() const override { return 6 * poses_; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;

 private:
  int poses_;
};

}  // namespace sextant
