// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// A place where the range jumps between two neighbouring returns: the silhouette of the nearer
/// surface lies somewhere between the two beams.
struct ScanEdge {
  /// Halfway between the two beams at the range of the nearer return, in the LiDAR frame [m]: the
  /// nearer return alone would shrink every object by half a step.
  Eigen::Vector3d point;
  Eigen::Vector3d across;  ///< Unit direction from one beam to the other.
  double gap_rad = 0.0;    ///< Angle between the beams; the edge is uniform within it.
  bool is_between_sweeps = false;
};

/// Depth edges along each sweep and between neighbouring sweeps, up to 60 m. Both surfaces must be
/// smooth beside the jump (no grass, no single returns), and a floor seen at a grazing angle is
/// none. Errors: those of FindSweeps. Time: O(n log n).
Expected<std::vector<ScanEdge>> FindScanEdges(const PointCloud& scan);

}  // namespace sextant
