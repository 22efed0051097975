// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "geometry/camera.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Why no point of the board's front, where it hangs at rest, is in the camera's image; empty
/// where one is. `camera` is what renders. What hides what is not looked at.
std::string WhyUnseen(const SceneBoard& board, const SceneCamera& scene_camera,
                      const Camera& camera);

/// Whether the model's beams can meet a point of the board, by their angles and their range.
bool IsReached(const SceneBoard& board, const Rigid3d& world_from_lidar, const LidarModel& model);

}  // namespace sextant
