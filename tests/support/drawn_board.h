// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <array>
#include <numbers>
#include <vector>

#include "geometry/scan_marks.h"
#include "support/lidar_scenes.h"

namespace sextant::test {

/// A board's corners in the frame of a LiDAR: top, right, bottom, left.
using BoardCorners = std::array<Eigen::Vector3d, 4>;

inline BoardCorners CornersOf(const SceneBoard& board, const Rigid3d& world_from_lidar) {
  const Rigid3d lidar_from_board = world_from_lidar.Inverse() * board.world_from_board;
  const double x = 0.5 * board.board.top_right_m;
  const double y = 0.5 * board.board.right_bottom_m;
  return {lidar_from_board * Eigen::Vector3d(-x, -y, 0),
          lidar_from_board * Eigen::Vector3d(x, -y, 0), lidar_from_board * Eigen::Vector3d(x, y, 0),
          lidar_from_board * Eigen::Vector3d(-x, y, 0)};
}

/// Polygons that a person would draw around the edges of a board in that projection: they leave out
/// a tenth of the edge at both ends and extend `margin_m` to both sides.
inline MarkedBoard DrawBoard(int id, const BoardCorners& corners, const ScanMarks& projection,
                             double margin_m) {
  MarkedBoard drawn{.id = id, .edges = {}};
  const Eigen::Vector3d center = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  for (std::size_t edge = 0; edge < 4; ++edge) {
    const Eigen::Vector3d& from = corners[(edge + 3) % 4];
    const Eigen::Vector3d& to = corners[edge];
    const Eigen::Vector3d along = to - from;
    const Eigen::Vector3d outward = (0.5 * (from + to) - center).normalized() * margin_m;
    Quadrilateral quadrilateral{};
    const std::array<Eigen::Vector3d, 4> points = {
        from + 0.1 * along + outward, to - 0.1 * along + outward, to - 0.1 * along - outward,
        from + 0.1 * along - outward};
    for (std::size_t i = 0; i < 4; ++i) {
      const auto pixel = Project(projection.camera, projection.cam_from_lidar * points[i]);
      EXPECT_TRUE(pixel);
      quadrilateral[i] = pixel.value_or(Eigen::Vector2d::Zero());
    }
    drawn.edges.push_back(quadrilateral);
  }
  return drawn;
}

/// The paper's boards of 0.48 m, one corner up, 1.8 m in front of a LiDAR at the origin, with a
/// wall behind them.
inline Scene PlacedBoards(int boards) {
  Scene scene;
  scene.name = "two boards";
  for (int i = 0; i < boards; ++i) {
    const double side = boards == 1 ? 0.0 : 0.5 - 1.0 * i;
    const Eigen::Vector3d center(1.8, side, 0.02);
    SceneBoard board =
        PlainBoard(Facing(center, {1.0, 0.1, 0.05}, 0.25 * std::numbers::pi), 0.48, 0.48);
    board.board.id = i;
    scene.boards.push_back(board);
  }
  scene.walls = {Wall("behind", Facing({4, 0, 0}, {1, 0, 0}), 12, 6)};
  return scene;
}

}  // namespace sextant::test
