// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "features/lidar/rings/scan_rings.h"

namespace sextant {

/// Neighbouring returns of one ring without a jump in range between them. A run that crosses the
/// seam behind the sensor is split there; the clustering joins the parts.
struct RingRun {
  int ring = 0;
  std::size_t first = 0;  ///< Index into ScanRings::points().
  std::size_t count = 0;
};

/// Runs that touch each other: one object, judging by ranges.
using RingCluster = std::vector<RingRun>;

struct ClusterOptions {
  double longest_run_m = 1.0;  ///< Longer runs are walls and floors and are omitted.
  double jump_m = 0.06;  ///< A larger step in range separates objects: 3 sigma of two returns.
};

/// Finds objects no wider than the limit. Two returns belong together if the surface between them
/// is inclined by at most 60 degrees (between rings) or 75 (within a ring) against the ray's
/// normal. Degenerate: a board that touches a wall becomes part of the wall.
std::vector<RingCluster> ClusterRings(const ScanRings& scan, const ClusterOptions& options);

}  // namespace sextant
