// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/random.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// How a board hangs before a LiDAR at the world's origin; angles in degrees.
struct BoardPlacement {
  double azimuth_deg = 0.0;
  double distance_m = 1.8;
  double height_m = 0.0;
  double turn_deg = 45.0;  ///< In its plane; 45 hangs a square board from its corner 0.
  double yaw_deg = 0.0;    ///< Out of the square view, about the vertical.
  double pitch_deg = 0.0;
};

SceneBoard PlaceBoard(const Board& board, const BoardPlacement& placement);

/// A room of 10 m x 10 m without a board: floor, walls, a person, a cupboard, a pole, by chance.
Scene FurnishedRoom(Random& random);

/// Where two boards hang, one left and one right of the LiDAR's x axis; drawn uniformly.
struct BoardField {
  double distance_m = 1.8;  ///< Within 5 %.
  double min_azimuth_deg = 12.0;
  double max_azimuth_deg = 25.0;
  double height_m = 0.0;
  double height_spread_m = 0.1;  ///< To both sides.
  double turned_deg = 8.0;       ///< At most, from hanging by a corner, in the board's plane.
};

/// Where they are wholly within what a LiDAR sees; of one that sees too little for two boards at
/// that distance, as near to it as can be.
BoardField FieldOf(const LidarModel& model, double distance_m);

/// The paper's two boards in a room, turned out of the square view by up to 30 degrees.
Scene TwoBoardsInRoom(const BoardField& field, Random& random);

/// A stand that holds a board from behind: a pole from the floor to above its lowest corner, as
/// near to its back as it gets, and a tripod's hub and feet below. Requires a scene of
/// TwoBoardsInRoom.
void AddStand(const SceneBoard& placed, Scene& scene);

/// A person within a forearm behind a board, with both hands over its lower edges.
void AddHolder(const SceneBoard& placed, Random& random, Scene& scene);

/// Boards of a scene, in its order.
std::vector<Board> BoardsIn(const Scene& scene);

/// Corner i of board b in the world.
Eigen::Vector3d TrueCorner(const SceneBoard& placed, int corner);

}  // namespace sextant
