// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "geometry/so3.h"

namespace sextant {

/// A rigid transform, named by its frames: `b_from_a * point_in_a = point_in_b`.
struct Rigid3d {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  ///< Unit length.
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();         ///< Metres.

  Eigen::Vector3d operator*(const Eigen::Vector3d& point) const {
    return rotation * point + translation;
  }

  /// c_from_b * b_from_a = c_from_a.
  Rigid3d operator*(const Rigid3d& other) const {
    return {(rotation * other.rotation).normalized(), rotation * other.translation + translation};
  }

  Rigid3d Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return {inverse, -(inverse * translation)};
  }

  Eigen::Matrix4d Matrix() const;
  bool IsFinite() const { return rotation.coeffs().allFinite() && translation.allFinite(); }
};

/// The pose perturbed by delta = (dphi [rad], dt [m]): R = Exp(dphi) R_hat, t = t_hat + dt.
/// Every 6x6 covariance of the library is of this delta, in this order.
Rigid3d Perturb(const Rigid3d& pose, const Vector6d& delta);

/// The delta with Perturb(reference, delta) = pose.
Vector6d PoseDifference(const Rigid3d& pose, const Rigid3d& reference);

/// The distance between two poses.
struct PoseDistance {
  double rotation_rad = 0.0;   ///< Geodesic.
  double translation_m = 0.0;  ///< Between the two translations.
};
PoseDistance DistanceBetween(const Rigid3d& a, const Rigid3d& b);

}  // namespace sextant
