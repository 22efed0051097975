// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant {

/// The rotation of the other pose at which a flat set of points looks nearly the same: the
/// reflection in the plane perpendicular to the line of sight, of the set reflected in itself.
/// `sight`: unit, towards the centroid, in the camera frame; `normal`: unit, of the set, in its own
/// frame. Source: Oberkampf, DeMenthon and Davis 1996, "Iterative pose estimation using coplanar
/// feature points". O(1).
inline Eigen::Matrix3d MirroredRotation(const Eigen::Matrix3d& rotation,
                                        const Eigen::Vector3d& sight,
                                        const Eigen::Vector3d& normal) {
  const Eigen::Matrix3d reflect = Eigen::Matrix3d::Identity() - 2.0 * sight * sight.transpose();
  const Eigen::Matrix3d flip = Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
  return reflect * rotation * flip;
}

}  // namespace sextant
