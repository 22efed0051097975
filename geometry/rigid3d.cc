// SPDX-License-Identifier: Apache-2.0
#include "geometry/rigid3d.h"

namespace sextant {

Eigen::Matrix4d Rigid3d::Matrix() const {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  m.topRightCorner<3, 1>() = translation;
  return m;
}

Rigid3d Perturb(const Rigid3d& pose, const Vector6d& delta) {
  return {(ExpSo3(delta.head<3>()) * pose.rotation).normalized(),
          pose.translation + delta.tail<3>()};
}

Vector6d PoseDifference(const Rigid3d& pose, const Rigid3d& reference) {
  Vector6d delta;
  delta << LogSo3(pose.rotation * reference.rotation.conjugate()),
      pose.translation - reference.translation;
  return delta;
}

PoseDistance DistanceBetween(const Rigid3d& a, const Rigid3d& b) {
  return {RotationDistance(a.rotation, b.rotation), (a.translation - b.translation).norm()};
}

}  // namespace sextant
