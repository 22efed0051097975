// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene.h"

#include <cmath>
#include <numbers>

namespace sextant {

Rigid3d BoardPoseAt(const SceneBoard& board, double time_s) {
  if (!board.swing) return board.world_from_board;
  const Swing& swing = *board.swing;
  const double angle = swing.amplitude_rad *
                       std::sin(2.0 * std::numbers::pi * time_s / swing.period_s + swing.phase_rad);
  const Eigen::Vector3d pivot_in_world =
      board.world_from_board *
      Eigen::Vector3d(-0.5 * board.board.top_right_m, -0.5 * board.board.right_bottom_m, 0.0);
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(angle, swing.axis_in_world.normalized()));
  return {turn * board.world_from_board.rotation,
          pivot_in_world + turn * (board.world_from_board.translation - pivot_in_world)};
}

std::vector<Board> BoardsIn(const Scene& scene) {
  std::vector<Board> boards;
  for (const SceneBoard& board : scene.boards) boards.push_back(board.board);
  return boards;
}

Eigen::Vector3d TrueCorner(const SceneBoard& board, int corner) {
  const double x = corner == 1 || corner == 2 ? 0.5 : -0.5;
  const double y = corner >= 2 ? 0.5 : -0.5;
  return board.world_from_board *
         Eigen::Vector3d(x * board.board.top_right_m, y * board.board.right_bottom_m, 0.0);
}

}  // namespace sextant
