// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/scene_visibility.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace sextant {
namespace {

std::vector<Eigen::Vector3d> PointsInWorld(const SceneBoard& board) {
  constexpr int kSteps = 8;
  std::vector<Eigen::Vector3d> points;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const double x = (1.0 * column / kSteps - 0.5) * board.board.top_right_m;
      const double y = (1.0 * row / kSteps - 0.5) * board.board.right_bottom_m;
      points.push_back(board.world_from_board * Eigen::Vector3d(x, y, 0.0));
    }
  }
  return points;
}

}  // namespace

std::string WhyUnseen(const SceneBoard& board, const SceneCamera& scene_camera,
                      const Camera& camera) {
  const Eigen::Vector3d camera_in_board =
      board.world_from_board.Inverse() * scene_camera.world_from_cam.translation;
  if (camera_in_board.z() >= 0.0) return "its back faces camera '" + scene_camera.name + "'";
  const Rigid3d cam_from_world = scene_camera.world_from_cam.Inverse();
  bool is_in_front = false;
  for (const Eigen::Vector3d& point : PointsInWorld(board)) {
    const Eigen::Vector3d in_cam = cam_from_world * point;
    is_in_front = is_in_front || in_cam.z() > 0.0;
    const std::optional<Eigen::Vector2d> pixel = Project(camera, in_cam);
    if (pixel && pixel->x() > -0.5 && pixel->x() < camera.width_px - 0.5 && pixel->y() > -0.5 &&
        pixel->y() < camera.height_px - 0.5) {
      return "";
    }
  }
  return (is_in_front ? "it is outside the image of camera '" : "it is behind camera '") +
         scene_camera.name + "'";
}

bool IsReached(const Eigen::Vector3d& in_lidar, const LidarModel& model) {
  const double range = in_lidar.norm();
  if (range < model.min_range_m || range > model.max_range_m) return false;
  const double off_axis = std::atan2(in_lidar.tail<2>().norm(), in_lidar.x());
  if (model.rosette) return off_axis <= 2.0 * model.rosette->deflection_rad;
  constexpr double kSlack_rad = 1e-3;
  const double elevation = std::atan2(in_lidar.z(), in_lidar.head<2>().norm());
  return elevation >= model.rings.front().elevation_rad - kSlack_rad &&
         elevation <= model.rings.back().elevation_rad + kSlack_rad;
}

bool IsReached(const SceneBoard& board, const Rigid3d& world_from_lidar, const LidarModel& model) {
  const Rigid3d lidar_from_world = world_from_lidar.Inverse();
  const std::vector<Eigen::Vector3d> points = PointsInWorld(board);
  return std::any_of(points.begin(), points.end(), [&](const Eigen::Vector3d& point) {
    return IsReached(lidar_from_world * point, model);
  });
}

}  // namespace sextant
