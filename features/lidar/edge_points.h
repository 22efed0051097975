// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "features/lidar/lidar_plane.h"
#include "features/lidar/scan_rings.h"

namespace sextant {

/// Where the samples of a ring leave the board, in the board's plane.
///
/// The true edge lies somewhere between the last return on the board and the first beyond it, so
/// its position along the ring is uniform over one step; the estimate is the middle. The ray's
/// angles are far better known than its range, so positions are rays met with the plane.
struct EdgePoint {
  Eigen::Vector2d in_plane = Eigen::Vector2d::Zero();  ///< Estimate of the edge [m].
  Eigen::Vector2d outward = Eigen::Vector2d::UnitX();  ///< Unit, along the ring, off the board.
  double step_m = 0.0;                                 ///< Distance of neighbouring samples there.
  double beam_sigma_m = 0.0;  ///< Of the beam's own width, across the ring.
  bool across = false;        ///< Between two rings: the board's upper or lower end.
  bool inner = false;         ///< Of a hollow board's opening.
  int ring = 0;
  Eigen::Vector3d last_return = Eigen::Vector3d::Zero();  ///< As measured, uncorrected [m].
};

/// The spot that a beam makes, as wide as aperture + divergence x range. An edge is seen too far
/// out by about a third of it: the strongest echo wins, but spots that hardly touch are lost. A
/// simulated VLP-16 at 1.8 m: 5 mm, a real one 2 to 4 (docs/simulator.md).
struct LidarBeam {
  double aperture_m = 0.0095;     ///< As it leaves; VLP-16.
  double divergence_rad = 0.003;  ///< Full angle; VLP-16.

  double SpotAt(double range_m) const { return aperture_m + divergence_rad * range_m; }
};

struct EdgeOptions {
  bool hollow = false;  ///< Gaps within a ring are edges of the opening.
  bool correct = true;  ///< Off: the last return itself, as the paper takes it.
  LidarBeam beam{};
};

/// First and last return of each ring among the plane's points, and the middles of the highest and
/// lowest ring, where the edge lies before the next one. Edges that something nearer hides are left
/// out. `on_plane`: places within scan.points().
std::vector<EdgePoint> FindEdgePoints(const ScanRings& scan, const LidarPlane& plane,
                                      std::span<const std::size_t> on_plane,
                                      const EdgeOptions& options);

}  // namespace sextant
