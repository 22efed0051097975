// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/random.h"
#include "eval/synthetic/simulate_views.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"

namespace sextant {

// What one sensor observes of one board, as ViewSimulation describes it.

Board BoardOf(const ViewSimulation& simulation);

/// cam_from_board with the centre near the LiDAR's horizon, as the LiDAR has the narrower vertical
/// field of view, and the front towards the camera.
Rigid3d DrawBoardPose(const ViewSimulation& simulation, const Rigid3d& cam_from_lidar,
                      Random& random);

/// What one unit of the LiDAR adds to its measurements.
struct UnitErrors {
  std::vector<double> ring_offsets_m;                  ///< With the constant of all rings.
  Eigen::Vector2d growth_m = Eigen::Vector2d::Zero();  ///< Along and across the scan direction.
};

UnitErrors DrawUnit(const ViewSimulation& simulation);

/// The shift of all returns of one view, as of their board.
Rigid3d DrawViewShift(const ViewSimulation& simulation, int view);

/// Appends the returns and edge rays of a board in a scan with rings.
void AddReturns(const ViewSimulation& simulation, const UnitErrors& unit, const Board& board,
                const Rigid3d& lidar_from_board, BoardView& view, Random& random);

/// Whether two rays are on each side, which fix the rectangle in its plane.
bool HasAllSides(const BoardView& view);

/// Whether the tag's corners are in the image.
bool IsInImage(const Camera& camera, const Board& board, const Rigid3d& cam_from_board);

/// Appends the tag's corners. Requires IsInImage.
void AddTag(const ViewSimulation& simulation, const Camera& camera, const Board& board,
            const Rigid3d& cam_from_board, BoardView& view, Random& random);

}  // namespace sextant
