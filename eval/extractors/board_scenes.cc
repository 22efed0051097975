// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/board_scenes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/units.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

constexpr double kFloor_m = -1.0;

// Rotation of a plane that faces the origin from this azimuth: z points away, y down.
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
       .world_from_wall = {RotationBetween(Eigen::Vector3d::UnitZ(), -Eigen::Vector3d::UnitZ()),
                           Eigen::Vector3d(0.0, 0.0, kFloor_m)},
       .width_m = 2.0 * kHalf_m,
       .height_m = 2.0 * kHalf_m});
}

}  // namespace

SceneBoard PlaceBoard(const Board& board, const ScenePlacement& placement) {
  const double azimuth = placement.azimuth_deg * kRadPerDeg;
  SceneBoard placed;
  placed.board = board;
  placed.world_from_board.translation = At(azimuth, placement.distance_m, placement.height_m);
  placed.world_from_board.rotation =
      Facing(azimuth) *
      Eigen::AngleAxisd(placement.yaw_deg * kRadPerDeg, Eigen::Vector3d::UnitY()) *
      Eigen::AngleAxisd(placement.pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitX()) *
      Eigen::AngleAxisd(placement.turn_deg * kRadPerDeg, Eigen::Vector3d::UnitZ());
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

BoardField FieldOf(const LidarModel& model, double distance_m) {
  constexpr double kHalfDiagonal_m = 0.36;
  const auto reach_deg = [](double m) { return std::atan(kHalfDiagonal_m / m) / kRadPerDeg; };
  BoardField field{.distance_m = distance_m};
  if (model.rosette) {
    const double half_view_deg = 2.0 * model.rosette->deflection_rad / kRadPerDeg;
    // Next to each other, each no wider than half the field of view.
    field.distance_m =
        std::max(distance_m, 1.1 * kHalfDiagonal_m / std::tan(0.5 * half_view_deg * kRadPerDeg));
    field.min_azimuth_deg = reach_deg(0.95 * field.distance_m);
    field.max_azimuth_deg = half_view_deg - field.min_azimuth_deg;
    return field;
  }
  // Next to each other as well: nearer boards would overlap.
  field.min_azimuth_deg = std::max(field.min_azimuth_deg, reach_deg(0.95 * distance_m));
  const double low_deg = model.rings.front().elevation_rad / kRadPerDeg;
  const double high_deg = model.rings.back().elevation_rad / kRadPerDeg;
  const double reach = reach_deg(0.95 * distance_m);
  const double spread_deg =
      std::clamp(0.5 * (high_deg - low_deg) - reach, 0.0, std::atan(0.1 / distance_m) / kRadPerDeg);
  const double lowest_deg = low_deg + reach + spread_deg;
  const double highest_deg = high_deg - reach - spread_deg;
  const double middle_deg = lowest_deg < highest_deg ? std::clamp(0.0, lowest_deg, highest_deg)
                                                     : 0.5 * (low_deg + high_deg);
  field.height_m = distance_m * std::tan(middle_deg * kRadPerDeg);
  field.height_spread_m = distance_m * std::tan(spread_deg * kRadPerDeg);
  return field;
}

Scene TwoBoardsInRoom(const BoardField& field, Random& random) {
  Scene scene;
  AddWalls(scene);
  for (int i = 0; i < 2; ++i) {
    Board board;
    board.id = i;
    board.top_right_m = i == 0 ? 0.484 : 0.490;
    board.right_bottom_m = 0.468;
    ScenePlacement placement;
    placement.azimuth_deg =
        (i == 0 ? 1.0 : -1.0) * random.Uniform(field.min_azimuth_deg, field.max_azimuth_deg);
    placement.distance_m = field.distance_m * random.Uniform(0.95, 1.05);
    placement.height_m =
        field.height_m + random.Uniform(-field.height_spread_m, field.height_spread_m);
    placement.turn_deg = 45.0 + random.Uniform(-field.turned_deg, field.turned_deg);
    placement.yaw_deg = random.Uniform(-30.0, 30.0);
    placement.pitch_deg = random.Uniform(-15.0, 15.0);
    scene.boards.push_back(PlaceBoard(board, placement));
  }
  return scene;
}

void AddStand(const SceneBoard& placed, Scene& scene) {
  constexpr double kRadius_m = 0.015;
  constexpr double kClamp_m = 0.1;  // Reach above the lowest corner.
  const Eigen::Vector3d away = placed.world_from_board.rotation * Eigen::Vector3d::UnitZ();
  const double behind = 0.005 + kRadius_m / std::hypot(away.x(), away.y());
  const Eigen::Vector3d top =
      TrueCorner(placed, 2) + behind * away + kClamp_m * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d foot(top.x(), top.y(), kFloor_m);
  scene.cylinders.push_back({.name = "pole",
                             .base_in_world = foot,
                             .radius_m = kRadius_m,
                             .height_m = top.z() - kFloor_m});
  scene.cylinders.push_back(
      {.name = "hub", .base_in_world = foot, .radius_m = 0.03, .height_m = 0.3});
  scene.cylinders.push_back(
      {.name = "feet", .base_in_world = foot, .radius_m = 0.3, .height_m = 0.03});
}

void AddHolder(const SceneBoard& placed, Random& random, Scene& scene) {
  constexpr double kBody_m = 0.2;
  // From the board's centre to the body, so that a tilted board does not touch it.
  const double gap = random.Uniform(0.22, 0.45);
  const double beside = random.Uniform(-0.1, 0.1);
  const Eigen::Vector3d center = placed.world_from_board.translation;
  const Eigen::Vector3d away = Eigen::Vector3d(center.x(), center.y(), 0.0).normalized();
  const Eigen::Vector3d left = Eigen::Vector3d::UnitZ().cross(away);
  const Eigen::Vector3d body = center + (gap + kBody_m) * away + beside * left;
  scene.cylinders.push_back({.name = "person",
                             .base_in_world = {body.x(), body.y(), kFloor_m},
                             .radius_m = kBody_m,
                             .height_m = 1.75});
  // Each hand grips an edge at the bottom corner, half of it in front of the board.
  for (const int side : {1, 3}) {
    const double along = random.Uniform(0.3, 0.7);
    const Eigen::Vector3d grip =
        (1.0 - along) * TrueCorner(placed, 2) + along * TrueCorner(placed, side);
    scene.boxes.push_back({.name = "hand",
                           .world_from_box = {placed.world_from_board.rotation, grip},
                           .size_m = Eigen::Vector3d(0.08, 0.08, 0.06)});
    const Eigen::Vector3d shoulder =
        body + (side == 1 ? -kBody_m : kBody_m) * left + 0.3 * Eigen::Vector3d::UnitZ();
    const Eigen::Vector3d arm = shoulder - grip;
    const Eigen::Vector3d inward = 0.04 * arm.normalized();
    scene.boxes.push_back({.name = "arm",
                           .world_from_box = {RotationBetween(Eigen::Vector3d::UnitX(), arm),
                                              0.5 * (grip + shoulder) + inward},
                           .size_m = Eigen::Vector3d(arm.norm(), 0.07, 0.07)});
  }
}

}  // namespace sextant
