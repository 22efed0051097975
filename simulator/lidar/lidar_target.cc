// SPDX-License-Identifier: Apache-2.0
#include "simulator/lidar/lidar_target.h"

#include <cmath>

namespace sextant {
namespace {

Expected<LidarTarget> FromBoard(const SceneBoard& board, const Rigid3d& lidar_from_world) {
  LidarTarget target;
  target.object = SceneObject::kBoard;
  const Board& shape = board.board;
  target.block.high = {0.5 * shape.top_right_m, 0.5 * shape.right_bottom_m, shape.thickness_m};
  target.block.low = {-target.block.high.x(), -target.block.high.y(), 0.0};
  if (shape.hole) {
    const Eigen::Vector2d half(0.5 * shape.hole->width_m, 0.5 * shape.hole->height_m);
    target.block.has_hole = true;
    target.block.hole_low = shape.hole->center_in_board_m - half;
    target.block.hole_high = shape.hole->center_in_board_m + half;
  }
  target.block.round_holes = shape.round_holes;
  target.white_reflectivity = board.white.reflectivity;
  target.black_reflectivity = board.black.reflectivity;
  if (!shape.tags.empty() || shape.checker) {
    SEXTANT_ASSIGN_OR_RETURN(BoardPrint print, BoardPrint::Make(shape));
    target.print = std::move(print);
  }
  target.target_from_lidar = (lidar_from_world * board.world_from_board).Inverse();
  // A swinging board rotates about its corner 0 and stays within the length of its diagonal from
  // it.
  const Eigen::Vector3d& low = target.block.low;
  const Eigen::Vector3d& high = target.block.high;
  const Eigen::Vector3d center = board.swing ? low : Eigen::Vector3d(0.5 * (low + high));
  target.center_in_lidar = lidar_from_world * (board.world_from_board * center);
  target.reach_m = (high - low).norm() * (board.swing ? 1.0 : 0.5);
  if (board.swing) target.swinging = board;
  return target;
}

// A block of the given size, centred on its own origin.
LidarTarget FromBlock(SceneObject object, const Eigen::Vector3d& size_m,
                      const Rigid3d& lidar_from_block, const Surface& surface) {
  LidarTarget target;
  target.object = object;
  target.block.low = -0.5 * size_m;
  target.block.high = 0.5 * size_m;
  target.white_reflectivity = surface.reflectivity;
  target.target_from_lidar = lidar_from_block.Inverse();
  target.center_in_lidar = lidar_from_block.translation;
  target.reach_m = 0.5 * size_m.norm();
  return target;
}

LidarTarget FromCylinder(const SceneCylinder& cylinder, const Rigid3d& lidar_from_world) {
  LidarTarget target;
  target.object = SceneObject::kCylinder;
  target.is_cylinder = true;
  target.cylinder = {.radius_m = cylinder.radius_m, .height_m = cylinder.height_m};
  target.white_reflectivity = cylinder.surface.reflectivity;
  const Rigid3d world_from_cylinder{Eigen::Quaterniond::Identity(), cylinder.base_in_world};
  const Rigid3d lidar_from_cylinder = lidar_from_world * world_from_cylinder;
  target.target_from_lidar = lidar_from_cylinder.Inverse();
  target.center_in_lidar = lidar_from_cylinder * Eigen::Vector3d(0, 0, 0.5 * cylinder.height_m);
  target.reach_m = std::hypot(cylinder.radius_m, 0.5 * cylinder.height_m);
  return target;
}

}  // namespace

double LidarTarget::CosIncidence(const LidarRay& ray, const LidarEntry& entry) const {
  if (!is_cylinder || entry.face == 2) return std::abs(ray.direction[entry.face]);
  const Eigen::Vector3d point = ray.origin + entry.range_m * ray.direction;
  return std::abs(point.head<2>().dot(ray.direction.head<2>())) / cylinder.radius_m;
}

Rigid3d LidarTarget::TargetFromLidar(const Rigid3d& world_from_lidar, double time_s) const {
  if (!swinging) return target_from_lidar;
  return BoardPoseAt(*swinging, time_s).Inverse() * world_from_lidar;
}

Expected<std::vector<LidarTarget>> MakeLidarTargets(const Scene& scene) {
  SEXTANT_RETURN_IF_ERROR(CheckLidarScene(scene));
  const Rigid3d lidar_from_world = scene.lidar.world_from_lidar.Inverse();
  std::vector<LidarTarget> targets;
  const auto add = [&targets](LidarTarget target, std::size_t index) {
    target.index = static_cast<int>(index);
    targets.push_back(std::move(target));
  };
  for (std::size_t i = 0; i < scene.boards.size(); ++i) {
    SEXTANT_ASSIGN_OR_RETURN(LidarTarget target, FromBoard(scene.boards[i], lidar_from_world));
    add(std::move(target), i);
  }
  for (std::size_t i = 0; i < scene.walls.size(); ++i) {
    const SceneWall& wall = scene.walls[i];
    add(FromBlock(SceneObject::kWall, {wall.width_m, wall.height_m, 0.0},
                  lidar_from_world * wall.world_from_wall, wall.surface),
        i);
  }
  for (std::size_t i = 0; i < scene.boxes.size(); ++i) {
    const SceneBox& box = scene.boxes[i];
    add(FromBlock(SceneObject::kBox, box.size_m, lidar_from_world * box.world_from_box,
                  box.surface),
        i);
  }
  for (std::size_t i = 0; i < scene.cylinders.size(); ++i) {
    add(FromCylinder(scene.cylinders[i], lidar_from_world), i);
  }
  SEXTANT_RETURN_IF_ERROR(CheckLidarOutside(scene, targets));
  return targets;
}

}  // namespace sextant
