// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "features/lidar/edge_points.h"

namespace sextant {

/// Edge points of a scan without rings: pairs of a return on the plane and a ray past it that are
/// mutual nearest neighbours. The position of the edge is uniform between the two, because neither
/// kind is favoured. An edge without returns beyond it gives no edge points.
/// `on_plane`: indices into scan.points(), ascending.
std::vector<EdgePoint> FindEdgePairs(const ScanRings& scan, const LidarPlane& plane,
                                     std::span<const std::size_t> on_plane,
                                     const EdgeOptions& options);

}  // namespace sextant
