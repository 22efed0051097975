// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/random.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Placement of a board in front of a LiDAR at the world's origin; angles in degrees.
struct ScenePlacement {
  double azimuth_deg = 0.0;
  double distance_m = 1.8;
  double height_m = 0.0;
  double turn_deg = 45.0;  ///< Rotation in its plane; at 45, corner 0 of a square board is up.
  double yaw_deg = 0.0;    ///< Rotation about the vertical; 0: the board faces the LiDAR.
  double pitch_deg = 0.0;
};

/// The board with the pose of the placement.
SceneBoard PlaceBoard(const Board& board, const ScenePlacement& placement);

/// A room of 10 m x 10 m without a board: floor, walls, and a person, a cupboard and a pole at
/// random places.
Scene FurnishedRoom(Random& random);

/// Ranges from which the placements of two boards are drawn uniformly, one to the left and one to
/// the right of the LiDAR's x axis.
struct BoardField {
  double distance_m = 1.8;  ///< Drawn within 5 % of this.
  double min_azimuth_deg = 12.0;
  double max_azimuth_deg = 25.0;
  double height_m = 0.0;
  double height_spread_m = 0.1;  ///< Drawn within this above and below height_m.
  double turned_deg = 8.0;       ///< Maximum rotation in the board's plane away from one corner up.
};

/// Ranges in which both boards are completely in the LiDAR's field of view. If the field of view is
/// too small for two boards at that distance, the nearest distance at which they fit.
BoardField FieldOf(const LidarModel& model, double distance_m);

/// The paper's two boards in a room, rotated about the vertical by up to 30 degrees.
Scene TwoBoardsInRoom(const BoardField& field, Random& random);

/// Adds a stand that holds a board from behind: a pole that touches the board's back and reaches
/// from the floor to above its lowest corner, with a tripod's hub and feet below. Requires a scene
/// of TwoBoardsInRoom.
void AddStand(const SceneBoard& placed, Scene& scene);

/// Adds a person within a forearm's length behind a board, with both hands over its lower edges.
void AddHolder(const SceneBoard& placed, Random& random, Scene& scene);

}  // namespace sextant
