// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "features/lidar/board_finder.h"
#include "geometry/board.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// For a scan that shows none of the boards: boards of their shape and of half to twice their size
/// that it shows, with what these measure, a line each. Slow (about 20 searches a board), for when
/// it is needed. Empty where there are none, and for a scan without returns.
std::vector<std::string> ProbeSizes(const PointCloud& cloud, std::span<const Board> boards,
                                    const BoardSearchOptions& options);

}  // namespace sextant
