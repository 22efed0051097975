// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/calibration_problem.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The two residuals of the library, shared by evaluation, consensus scoring and Ceres.

/// point_in_cam - (R point_in_lidar + t) [m], for any scalar type.
template <class T>
Eigen::Matrix<T, 3, 1> PointResidual(const Eigen::Quaternion<T>& rotation,
                                     const Eigen::Matrix<T, 3, 1>& translation,
                                     const Pair3d3d& pair) {
  return pair.point_in_cam.cast<T>() -
         (rotation * pair.point_in_lidar.cast<T>().eval() + translation);
}

inline Eigen::Vector3d PointResidual(const Rigid3d& cam_from_lidar, const Pair3d3d& pair) {
  return PointResidual<double>(cam_from_lidar.rotation, cam_from_lidar.translation, pair);
}

/// pixel - projection [px]; none where the point does not project.
inline std::optional<Eigen::Vector2d> ReprojectionResidual(const Camera& camera,
                                                           const Rigid3d& cam_from_lidar,
                                                           const Pair2d3d& pair) {
  const std::optional<Eigen::Vector2d> projected =
      Project(camera, cam_from_lidar * pair.point_in_lidar);
  if (!projected) return std::nullopt;
  return Eigen::Vector2d(pair.pixel - *projected);
}

}  // namespace sextant
