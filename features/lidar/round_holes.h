// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "features/lidar/edge_points.h"
#include "geometry/board.h"

namespace sextant {

/// A round opening in the returns of a plane.
struct SeenHole {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< In the plane's axes [m].
  double radius_m = 0.0;                             ///< As it appears.
  /// The returns nearest to its centre, all around it; `inner`. They are moved out of the hole by
  /// what it appears too small: a whole rim determines the centre, whatever its radius.
  std::vector<EdgePoint> rim{};
};

/// Finds the round holes of about a radius in a plane: discs without returns that returns surround.
/// No rays through the holes are needed, so that clouds that were cropped around a board have them,
/// too. Wide spots make holes up to a quarter smaller. `on_plane`: indices into scan.points().
/// Time: O(n + area / radius^2).
std::vector<SeenHole> FindRoundHoles(const ScanRings& scan, const LidarPlane& plane,
                                     std::span<const std::size_t> on_plane, double radius_m,
                                     const EdgeOptions& options);

/// Placements (center, angle) of a board at which at least three of its round holes, or both of
/// two, are where holes were seen; those with most first, at most `max_count`.
std::vector<Eigen::Vector3d> PlacementsByHoles(std::span<const SeenHole> seen, const Board& board,
                                               std::size_t max_count);

/// All edge points of a board with round holes, and placements to start from.
struct HoledEdges {
  std::vector<EdgePoint> edges{};
  std::vector<Eigen::Vector3d> starts{};
};

/// Rims come from the rings' gaps where the scan has rings, else from FindRoundHoles.
HoledEdges FindHoledEdges(const ScanRings& scan, const LidarPlane& plane,
                          std::span<const std::size_t> on_plane, const Board& board,
                          const EdgeOptions& options);

}  // namespace sextant
