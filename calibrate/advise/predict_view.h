// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/lidar_pattern.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The two sensors, and about how they stand to each other.
struct SensorPair {
  Camera camera{};  ///< With its image size.
  LidarPattern lidar{};
  Rigid3d cam_from_lidar{};
  double pixel_sigma_px = 0.3;  ///< Of a printed point, per axis.
};

/// What both sensors would measure of a board held there, without errors and with the noise to
/// expect; none where one of them would not find it: a print that is not wholly in the image, seen
/// at more than 65 degrees or smaller than 20 pixels; fewer than four rings on the board; fewer
/// than two rings across a side.
///
/// Edges: where a ring crosses a side, uniform over a step between samples, and 0.18 of the beam's
/// spot besides, as FindEdgePoints states it.
std::optional<BoardView> PredictView(const SensorPair& sensors, const Board& board,
                                     const Rigid3d& cam_from_board);

}  // namespace sextant
