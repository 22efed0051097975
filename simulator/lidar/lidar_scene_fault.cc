// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <cmath>

#include "simulator/lidar/lidar_target.h"

namespace sextant {
namespace {

// More than any hand-written scene needs; each beam is tested against every object.
constexpr std::size_t kMaxObjects = 10000;

Expected<void> CheckPoseAndSizes(const std::string& what, const Rigid3d& pose,
                                 const Eigen::VectorXd& sizes_m) {
  if (!pose.IsFinite() || !sizes_m.allFinite()) {
    return MakeError(ErrorCode::kNonFinite,
                     fmt::format("{}: its pose or size is not finite", what));
  }
  if (sizes_m.minCoeff() <= 0.0) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{}: a side of {} m; sides must be positive", what, sizes_m.minCoeff()));
  }
  return {};
}

Expected<void> CheckBoard(const SceneBoard& board, std::size_t index) {
  const std::string what = fmt::format("board {} ('{}')", index, board.board.name);
  const auto sides = Eigen::Vector2d(board.board.top_right_m, board.board.right_bottom_m);
  SEXTANT_RETURN_IF_ERROR(CheckPoseAndSizes(what, board.world_from_board, sides));
  if (!(board.board.thickness_m >= 0.0) || !std::isfinite(board.board.thickness_m)) {
    return MakeError(ErrorCode::kInvalidInput, what + ": its thickness must be 0 or more");
  }
  if (board.swing && !(board.swing->period_s > 0.0 && board.swing->axis_in_world.norm() > 0.0)) {
    return MakeError(ErrorCode::kInvalidInput,
                     what + ": its swing needs a positive period and an axis with a direction");
  }
  return {};
}

Expected<void> CheckOutside(const LidarTarget& target, const std::string& what) {
  const Eigen::Vector3d p = target.target_from_lidar.translation;
  const bool inside = target.is_cylinder ? p.head<2>().norm() < target.cylinder.radius_m &&
                                               p.z() > 0.0 && p.z() < target.cylinder.height_m
                                         : (p - target.block.low).minCoeff() > 0.0 &&
                                               (target.block.high - p).minCoeff() > 0.0;
  if (!inside) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("the LiDAR is inside {}; move one of them", what));
}

}  // namespace

Expected<void> CheckLidarScene(const Scene& scene) {
  const std::size_t objects =
      scene.boards.size() + scene.walls.size() + scene.boxes.size() + scene.cylinders.size();
  if (objects > kMaxObjects) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("the scene has {} objects; {} at most are simulated", objects, kMaxObjects));
  }
  if (!scene.lidar.world_from_lidar.IsFinite()) {
    return MakeError(ErrorCode::kNonFinite, "the LiDAR's pose is not finite");
  }
  for (std::size_t i = 0; i < scene.boards.size(); ++i) {
    SEXTANT_RETURN_IF_ERROR(CheckBoard(scene.boards[i], i));
  }
  for (const SceneWall& wall : scene.walls) {
    SEXTANT_RETURN_IF_ERROR(CheckPoseAndSizes(fmt::format("wall '{}'", wall.name),
                                              wall.world_from_wall,
                                              Eigen::Vector2d(wall.width_m, wall.height_m)));
  }
  for (const SceneBox& box : scene.boxes) {
    SEXTANT_RETURN_IF_ERROR(
        CheckPoseAndSizes(fmt::format("box '{}'", box.name), box.world_from_box, box.size_m));
  }
  for (const SceneCylinder& cylinder : scene.cylinders) {
    const Rigid3d pose{Eigen::Quaterniond::Identity(), cylinder.base_in_world};
    SEXTANT_RETURN_IF_ERROR(
        CheckPoseAndSizes(fmt::format("cylinder '{}'", cylinder.name), pose,
                          Eigen::Vector2d(cylinder.radius_m, cylinder.height_m)));
  }
  return {};
}

Expected<void> CheckLidarOutside(const Scene& scene, const std::vector<LidarTarget>& targets) {
  for (const LidarTarget& target : targets) {
    const auto index = static_cast<std::size_t>(target.index);
    Expected<void> ok;
    if (target.object == SceneObject::kBox) {
      ok = CheckOutside(target, fmt::format("box '{}'", scene.boxes[index].name));
    } else if (target.object == SceneObject::kCylinder) {
      ok = CheckOutside(target, fmt::format("cylinder '{}'", scene.cylinders[index].name));
    }
    if (!ok) return ok;
  }
  return {};
}

}  // namespace sextant
