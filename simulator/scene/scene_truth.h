// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "simulator/scene/scene.h"

namespace sextant {

/// A corner that extractors look for, in all frames at one time [m].
struct CornerTruth {
  Eigen::Vector3d in_world = Eigen::Vector3d::Zero();
  Eigen::Vector3d in_lidar = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> in_cam{};  ///< One per camera of the scene.
  /// One per camera; none outside of the image.
  std::vector<std::optional<Eigen::Vector2d>> pixel{};
};

struct TagTruth {
  std::string family{};
  int id = 0;
  std::vector<CornerTruth> corners{};  ///< Clockwise as seen, from the tag's own top-left corner.
};

struct BoardTruth {
  int id = 0;
  Rigid3d world_from_board{};
  std::vector<CornerTruth> corners{};  ///< Four corners, then four of the hole if there is one.
  std::vector<TagTruth> tags{};
};

/// The true corners of every board at `time_s` after the session's start. Pixels are computed with
/// the rendering cameras, not with the assumed intrinsics. Requires a valid scene. Occlusions are
/// ignored.
std::vector<BoardTruth> BoardsAt(const Scene& scene, double time_s);

/// point_in_cam = cam_from_lidar * point_in_lidar.
Rigid3d CamFromLidar(const Scene& scene, const SceneCamera& camera);

}  // namespace sextant
