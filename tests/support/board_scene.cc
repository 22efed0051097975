// SPDX-License-Identifier: Apache-2.0
#include "support/board_scene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace sextant::test {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Seen squarely from the origin at an azimuth: z away, y down.
Eigen::Quaterniond Facing(double azimuth_rad) {
  const Eigen::Vector3d away(std::cos(azimuth_rad), std::sin(azimuth_rad), 0.0);
  const Eigen::Vector3d down = -Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d axes;
  axes << down.cross(away), down, away;
  return Eigen::Quaterniond(axes);
}

Eigen::Vector3d At(double azimuth_rad, double distance_m, double height_m) {
  return {distance_m * std::cos(azimuth_rad), distance_m * std::sin(azimuth_rad), height_m};
}

void AddWalls(Scene& scene) {
  constexpr double kHalf_m = 5.0;
  constexpr double kFloor_m = -1.0;
  constexpr double kHeight_m = 3.0;
  for (int i = 0; i < 4; ++i) {
    const double azimuth = 0.5 * std::numbers::pi * i;
    scene.walls.push_back(
        {.name = "wall",
         .world_from_wall = {Facing(azimuth), At(azimuth, kHalf_m, kFloor_m + 0.5 * kHeight_m)},
         .width_m = 2.0 * kHalf_m,
         .height_m = kHeight_m});
  }
  scene.walls.push_back(
      {.name = "floor",
       .world_from_wall = {Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(),
                                                              -Eigen::Vector3d::UnitZ()),
                           Eigen::Vector3d(0.0, 0.0, kFloor_m)},
       .width_m = 2.0 * kHalf_m,
       .height_m = 2.0 * kHalf_m});
}

}  // namespace

SceneBoard Hang(const Board& board, const Hanging& hanging) {
  const double azimuth = hanging.azimuth_deg * kRadPerDeg;
  SceneBoard placed;
  placed.board = board;
  placed.world_from_board.translation = At(azimuth, hanging.distance_m, hanging.height_m);
  placed.world_from_board.rotation =
      Facing(azimuth) * Eigen::AngleAxisd(hanging.yaw_deg * kRadPerDeg, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(hanging.pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(hanging.turn_deg * kRadPerDeg, Eigen::Vector3d::UnitZ());
  return placed;
}

Scene FurnishedRoom(Random& random) {
  Scene scene;
  AddWalls(scene);
  const double person = random.Uniform(-3.0, 3.0);
  const double person_at = random.Uniform(1.5, 4.0);
  scene.cylinders.push_back({.name = "person",
                             .base_in_world = At(person, person_at, -1.0),
                             .radius_m = 0.25,
                             .height_m = 1.75});
  const double pole = random.Uniform(-3.0, 3.0);
  const double pole_at = random.Uniform(1.5, 4.0);
  scene.cylinders.push_back({.name = "pole",
                             .base_in_world = At(pole, pole_at, -1.0),
                             .radius_m = 0.06,
                             .height_m = 3.0});
  const double cupboard = random.Uniform(-3.0, 3.0);
  const double cupboard_at = random.Uniform(2.5, 4.0);
  const double turn = random.Uniform(-0.5, 0.5);
  const double width = random.Uniform(0.5, 1.2);
  const double height = random.Uniform(0.8, 2.0);
  scene.boxes.push_back({.name = "cupboard",
                         .world_from_box = {Facing(cupboard) * Eigen::Quaterniond(Eigen::AngleAxisd(
                                                                   turn, Eigen::Vector3d::UnitY())),
                                            At(cupboard, cupboard_at, -1.0 + 0.5 * height)},
                         .size_m = Eigen::Vector3d(width, height, 0.5)});
  return scene;
}

Scene TwoBoardsInRoom(double distance_m, Random& random) {
  Scene scene;
  AddWalls(scene);
  for (int i = 0; i < 2; ++i) {
    Board board;
    board.id = i;
    board.top_right_m = i == 0 ? 0.484 : 0.490;
    board.right_bottom_m = 0.468;
    Hanging hanging;
    hanging.azimuth_deg = (i == 0 ? 1.0 : -1.0) * random.Uniform(12.0, 25.0);
    hanging.distance_m = distance_m * random.Uniform(0.95, 1.05);
    hanging.height_m = random.Uniform(-0.1, 0.1);
    hanging.turn_deg = 45.0 + random.Uniform(-8.0, 8.0);
    hanging.yaw_deg = random.Uniform(-30.0, 30.0);
    hanging.pitch_deg = random.Uniform(-15.0, 15.0);
    scene.boards.push_back(Hang(board, hanging));
  }
  return scene;
}

std::vector<Board> BoardsIn(const Scene& scene) {
  std::vector<Board> boards;
  for (const SceneBoard& placed : scene.boards) boards.push_back(placed.board);
  return boards;
}

Eigen::Vector3d TrueCorner(const SceneBoard& placed, int corner) {
  const double x = corner == 1 || corner == 2 ? 0.5 : -0.5;
  const double y = corner >= 2 ? 0.5 : -0.5;
  return placed.world_from_board *
         Eigen::Vector3d(x * placed.board.top_right_m, y * placed.board.right_bottom_m, 0.0);
}

}  // namespace sextant::test
