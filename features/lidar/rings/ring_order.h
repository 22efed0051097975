// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "features/lidar/rings/ring_numbers.h"

namespace sextant {

/// Ring numbers from the order of the points: one row per ring or per column of an organised cloud,
/// or the rings listed in each column, where invalid returns keep their place. Empty if no number
/// of rings makes the returns of each ring lie on a line (ring_line.h) that is narrow compared with
/// the distance to the next ring. Time: O(n + rings * tested returns).
std::vector<int> RingsByOrder(std::span<const UnsortedReturn> returns, std::size_t cloud_size);

}  // namespace sextant
