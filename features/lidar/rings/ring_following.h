// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "features/lidar/rings/ring_numbers.h"

namespace sextant {

/// Ring numbers of returns in any order, from elevations that change slowly: first from far returns
/// to near ones, along each ring's line (ring_line.h), as for beams that start beside the origin;
/// then along the azimuth, as for mirrors that tilt the fan. Empty where the ring of too many
/// returns is ambiguous, as in a rosette. Time: O(n (log n + rings)).
std::vector<int> RingsByFollowing(std::span<const UnsortedReturn> returns);

}  // namespace sextant
