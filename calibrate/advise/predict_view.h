// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/lidar_pattern.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The two sensors and their approximate relative pose.
struct SensorPair {
  Camera camera{};  ///< Its image size must be set.
  LidarPattern lidar{};
  Rigid3d cam_from_lidar{};
  double pixel_sigma_px = 0.3;  ///< Noise of a printed point, 1 sigma per axis.
};

/// The measurements of both sensors to expect of a board at this pose: without errors, but with the
/// sigmas of their noise. None where one sensor would not detect it: a print partly outside the
/// image, seen at more than 65 degrees or smaller than 20 pixels; fewer than four rings on the
/// board; fewer than two rings across a side.
///
/// Edge points lie where a ring crosses a side. Their sigma is that of a uniform distribution over
/// one sampling step, plus 0.18 of the beam's spot, as FindEdgePoints states it.
std::optional<BoardView> PredictView(const SensorPair& sensors, const Board& board,
                                     const Rigid3d& cam_from_board);

}  // namespace sextant
