// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "geometry/camera.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// The reason why no point of the board's front at rest is in the camera's image; empty if one is.
/// `camera` is the rendering camera. Occlusions are ignored.
std::string WhyUnseen(const SceneBoard& board, const SceneCamera& scene_camera,
                      const Camera& camera);

/// Whether a point [m, LiDAR frame] is within the angles and the range of the LiDAR model.
bool IsReached(const Eigen::Vector3d& in_lidar, const LidarModel& model);

/// Whether a point of the board at rest is within the angles and the range of the LiDAR model.
bool IsReached(const SceneBoard& board, const Rigid3d& world_from_lidar, const LidarModel& model);

}  // namespace sextant
