// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "features/lidar/rings/ring_numbers.h"

namespace sextant {

/// Ring numbers, from the lowest up, of returns that are listed ring after ring in the order of
/// elevation: each ring is a turn from an azimuth that all share, in either sense (KITTI). That
/// order is evidence enough, so that rings may be wider than the distance to the next one, as those
/// of beams that start up to 0.2 m beside the origin or whose motion was removed. Neighbouring
/// turns must be ordered where they have the same azimuth and distance, and elevations must step
/// where turns begin, unlike in a spiral. Empty otherwise, or if many turns miss half of their
/// azimuths. `returns` are in the order of the cloud. Time: O(n).
std::vector<int> RingsByTurns(std::span<const UnsortedReturn> returns);

}  // namespace sextant
