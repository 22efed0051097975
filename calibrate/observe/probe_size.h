// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "features/lidar/board_finder.h"
#include "geometry/board.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// For a scan in which no board was found: searches for boards of the same shapes and of half to
/// twice the size, and describes each one found with its measured size, one line per board. Slow
/// (about 20 searches per board). Empty where there are none, and for a scan without returns.
std::vector<std::string> ProbeSizes(const PointCloud& cloud, std::span<const Board> boards,
                                    const BoardSearchOptions& options);

}  // namespace sextant
