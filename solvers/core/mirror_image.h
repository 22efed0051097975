// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant {

/// The other rotation at which flat points look nearly the same from far away: the reflection of
/// the points, as `rotation` turns them, in the plane perpendicular to the line of sight, made a
/// rotation by a reflection in their own plane. `normal`: of the points, in their frame; `sight`:
/// to their centre, in the camera's frame. Both are unit vectors.
inline Eigen::Matrix3d MirroredRotation(const Eigen::Matrix3d& rotation,
                                        const Eigen::Vector3d& normal,
                                        const Eigen::Vector3d& sight) {
  const Eigen::Matrix3d reflect = Eigen::Matrix3d::Identity() - 2.0 * sight * sight.transpose();
  const Eigen::Matrix3d flip = Eigen::Matrix3d::Identity() - 2.0 * normal * normal.transpose();
  return reflect * rotation * flip;
}

}  // namespace sextant
