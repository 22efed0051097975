// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <utility>
#include <vector>

#include "calibrate/observe/observe.h"
#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The boards of a scan as if a camera had seen them, in the LiDAR's own frame and without print:
/// the scan of another LiDAR is then matched with it as with an image. A scan does not show prints,
/// so that each patch is taken for the board that its outline fits best, turned in the best of the
/// ways; where boards or ways are alike, this defines them.
struct ScanAsImage {
  Observation image{};  ///< in_image only.
  /// For each sighting the index of its patch in the scan, and of its placement there.
  std::vector<std::pair<int, int>> sources{};
};

ScanAsImage AsImage(const Observation& scan, std::span<const Rigid3d> known);

/// The raw observations of one sighting by the LiDAR itself; printed and cam_from_board are empty.
BoardView ViewOfSighting(const Observation& scan, const ScanAsImage& as_image, int sighting,
                         std::span<const Board> boards);

}  // namespace sextant
