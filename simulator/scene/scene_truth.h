// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulator/scene/scene.h"

namespace sextant {

/// A point that an extractor looks for, in every frame at one moment [m].
struct CornerTruth {
  Eigen::Vector3d in_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d in_lidar = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> in_cam{};                ///< One a camera of the scene.
  std::vector<std::optional<Eigen::Vector2d>> pixel{};  ///< The same; none outside the image.
};

struct TagTruth {
  std::string family{};
  int id = 0;
  std::vector<CornerTruth> corners{};  ///< From the tag's own top-left, clockwise as seen.
};

struct BoardTruth {
  int id = 0;
  Rigid3d world_from_board{};
  std::vector<CornerTruth> corners{};  ///< 4, and 4 of the hole where there is one.
  std::vector<TagTruth> tags{};
};

/// Where every board is `time_s` after the session's start. Pixels by the cameras that render, not
/// by what the pipeline is told. Requires a valid scene. What hides what is not looked at.
std::vector<BoardTruth> BoardsAt(const Scene& scene, double time_s);

/// point_in_cam = cam_from_lidar * point_in_lidar.
Rigid3d CamFromLidar(const Scene& scene, const SceneCamera& camera);

}  // namespace sextant
