// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/random.h"
#include "eval/simulator/scene.h"

namespace sextant::test {

/// How a board hangs before a LiDAR at the world's origin; angles in degrees.
struct Hanging {
  double azimuth_deg = 0.0;
  double distance_m = 1.8;
  double height_m = 0.0;
  double turn_deg = 45.0;  ///< In its plane; 45 hangs a square board from its corner 0.
  double yaw_deg = 0.0;    ///< Out of the square view, about the vertical.
  double pitch_deg = 0.0;
};

SceneBoard Hang(const Board& board, const Hanging& hanging);

/// A room of 10 m x 10 m without a board: floor, walls, a person, a cupboard, a pole, by chance.
Scene FurnishedRoom(Random& random);

/// The paper's two boards about `distance_m` away, hung by chance within 8 degrees of a corner and
/// turned by up to 30 degrees, in a room.
Scene TwoBoardsInRoom(double distance_m, Random& random);

/// Boards of a scene, in its order.
std::vector<Board> BoardsIn(const Scene& scene);

/// Corner i of board b in the world.
Eigen::Vector3d TrueCorner(const SceneBoard& board, int corner);

}  // namespace sextant::test
