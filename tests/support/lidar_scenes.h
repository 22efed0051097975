// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/scene.h"

namespace sextant::test {

/// A rotation whose z axis points along `direction` in the world and whose y axis points down as
/// far as possible: a board that faces a sensor which sees it in that direction.
inline Rigid3d Facing(const Eigen::Vector3d& position, const Eigen::Vector3d& direction,
                      double roll_rad = 0.0) {
  const Eigen::Vector3d z = direction.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d rotation;
  rotation << x, z.cross(x), z;
  return {Eigen::Quaterniond(rotation) *
              Eigen::Quaterniond(Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ())),
          position};
}

inline SceneBoard PlainBoard(const Rigid3d& pose, double width_m, double height_m) {
  SceneBoard board;
  board.board.top_right_m = width_m;
  board.board.right_bottom_m = height_m;
  board.world_from_board = pose;
  return board;
}

inline SceneWall Wall(const std::string& name, const Rigid3d& pose, double width_m,
                      double height_m) {
  SceneWall wall;
  wall.name = name;
  wall.world_from_wall = pose;
  wall.width_m = width_m;
  wall.height_m = height_m;
  return wall;
}

/// A scene with every kind of object: a closed room of 10 x 8 x 3 m with two boards (one hollow,
/// one thick with a tag), a box and a person. The LiDAR is 1 m above the floor and tilted.
inline Scene FullRoom() {
  Scene scene;
  scene.name = "full room";
  scene.lidar.world_from_lidar = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d(0.3, 1.0, 0.2).normalized())),
      Eigen::Vector3d(0.0, 0.0, 1.0)};
  SceneBoard hollow = PlainBoard(Facing({2.0, 0.5, 1.0}, {1.0, 0.1, 0.05}, 0.8), 0.9, 0.9);
  hollow.board.hole = BoardHole{.width_m = 0.5, .height_m = 0.4};
  SceneBoard tagged = PlainBoard(Facing({1.9, -0.6, 1.0}, {1.0, -0.2, 0.0}, 0.75), 0.484, 0.468);
  tagged.board.thickness_m = 0.02;
  tagged.board.tags.push_back({.family = "aruco_original", .id = 26, .edge_m = 0.205});
  scene.boards = {hollow, tagged};
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  scene.walls = {Wall("front", Facing({5, 0, 1.5}, {1, 0, 0}), 8, 3),
                 Wall("back", Facing({-5, 0, 1.5}, {-1, 0, 0}), 8, 3),
                 Wall("left", Facing({0, 4, 1.5}, {0, 1, 0}), 10, 3),
                 Wall("right", Facing({0, -4, 1.5}, {0, -1, 0}), 10, 3)};
  Rigid3d floor;
  scene.walls.push_back(Wall("floor", floor, 10, 8));
  scene.walls.push_back(Wall("ceiling", {floor.rotation, 3.0 * up}, 10, 8));
  SceneBox box;
  box.name = "crate";
  box.size_m = {0.8, 0.6, 0.7};
  box.world_from_box = {Eigen::Quaterniond(Eigen::AngleAxisd(0.4, up)),
                        Eigen::Vector3d(-2.0, 1.0, 0.35)};
  scene.boxes = {box};
  scene.cylinders = {
      {.name = "person", .base_in_world = {-1.0, -2.0, 0.0}, .radius_m = 0.25, .height_m = 1.75}};
  return scene;
}

inline LidarModel Model(const std::string& name) {
  const Expected<LidarModel> model = FindLidarModel(name);
  EXPECT_TRUE(model) << name;
  return model.value_or(LidarModel{});
}

inline SimulatedScan Scan(const Scene& scene, const LidarModel& model, const ScanOptions& options) {
  Expected<SimulatedScan> scan = SimulateScan(scene, model, options);
  EXPECT_TRUE(scan) << scan.error().message;
  return scan ? *std::move(scan) : SimulatedScan{};
}

/// Options without noise, quantisation, beam width and lost returns.
inline ScanOptions Noiseless() {
  return {
      .noise = false, .quantisation = false, .divergence = false, .dropouts = false, .truth = true};
}

}  // namespace sextant::test
