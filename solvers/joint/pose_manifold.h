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

/// `kPoses` poses with the library's perturbation (Perturb).
///
/// Ceres multiplies a cost's derivative by the 7 numbers of a pose with PlusJacobian, and uses
/// neither otherwise. Here PlusJacobian is (I, 0), so that the first six columns of each pose (all
/// rotations and translations of the block first) are the derivative by its (dphi, dt): the costs
/// in this folder write that derivative into the first 6 kPoses columns and 0 into the others.
template <int kPoses>
class PoseManifold final : public ceres::Manifold {
 public:
  static constexpr int kAmbient = kPoseNumbers * kPoses;
  static constexpr int kTangent = 6 * kPoses;

  int AmbientSize() const override { return kAmbient; }
  int TangentSize() const override { return kTangent; }

  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    for (int i = 0; i < kPoses; ++i) {
      StorePose(Perturb(PoseIn(x + kPoseNumbers * i), Eigen::Map<const Vector6d>(delta + 6 * i)),
                x_plus_delta + kPoseNumbers * i);
    }
    return true;
  }
  bool PlusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kAmbient, kTangent, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    for (int i = 0; i < kPoses; ++i) {
      Eigen::Map<Vector6d>(y_minus_x + 6 * i) =
          PoseDifference(PoseIn(y + kPoseNumbers * i), PoseIn(x + kPoseNumbers * i));
    }
    return true;
  }
  bool MinusJacobian(const double* /*x*/, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, kTangent, kAmbient, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

}  // namespace sextant
