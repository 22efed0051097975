// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "features/lidar/edge_points.h"

namespace sextant {

/// Edge points of a scan without rings: pairs of a return on the plane and a ray past it of which
/// each is the other's nearest. The edge lies somewhere between the two, uniformly, since neither
/// kind is favoured. Where nothing returned beyond the board, nothing is known of its edge.
/// `on_plane`: places within scan.points(), ascending.
std::vector<EdgePoint> FindEdgePairs(const ScanRings& scan, const LidarPlane& plane,
                                     std::span<const std::size_t> on_plane,
                                     const EdgeOptions& options);

}  // namespace sextant
