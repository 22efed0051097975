// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "features/lidar/board_finder.h"
#include "geometry/board.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// How far away an image shows a board.
struct PhotoRange {
  int board = 0;  ///< Index into the boards.
  double range_m = 0.0;
};

/// For a scan in which no board was found: searches for those that its image shows, with the same
/// shape and two thirds to one and a half of the size, about as far away as in the image, and
/// describes each one found with its measured size, one line per board. Slow (about a dozen
/// searches per board). Empty where there are none, and for a scan without returns.
std::vector<std::string> ProbeSizes(const PointCloud& cloud, std::span<const Board> boards,
                                    std::span<const PhotoRange> in_image,
                                    const BoardSearchOptions& options);

}  // namespace sextant
