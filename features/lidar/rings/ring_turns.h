// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "features/lidar/rings/ring_numbers.h"

namespace sextant {

/// Ring numbers of returns that are listed ring by ring, each a whole turn or the same part of one,
/// without the rays that had no return (KITTI). Empty where the points do not go around in small
/// steps, or turns are not of one elevation each. Time: O(n).
std::vector<int> RingsByTurns(std::span<const UnsortedReturn> returns);

}  // namespace sextant
