// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "features/lidar/lidar_beam.h"
#include "features/lidar/lidar_plane.h"
#include "features/lidar/scan_rings.h"

namespace sextant {

/// Where the samples of a ring leave the board, in the board's plane.
///
/// The true edge lies somewhere between the last return on the board and the first beyond it, so
/// its position along the ring is uniform over one step; the estimate is the middle. The ray's
/// angles are far better known than its range, so positions are rays met with the plane. That the
/// beam is wide depends on the edge's direction: who knows it takes off GrownBy().
struct EdgePoint {
  Eigen::Vector2d in_plane = Eigen::Vector2d::Zero();  ///< Where the edge is seen [m].
  Eigen::Vector2d outward = Eigen::Vector2d::UnitX();  ///< Unit, along the ring, off the board.
  double step_m = 0.0;                                 ///< Distance of neighbouring samples there.
  Eigen::Vector2d spot_h = Eigen::Vector2d::Zero();  ///< Width of the beam's spot in the plane [m].
  Eigen::Vector2d spot_v = Eigen::Vector2d::Zero();  ///< Height of it.
  LidarBeam beam{};
  bool across = false;  ///< Between two rings: the board's upper or lower end.
  bool inner = false;   ///< Of a hollow board's opening.
  int ring = 0;
  Eigen::Vector3d last_return = Eigen::Vector3d::Zero();  ///< As measured, uncorrected [m].

  /// Width of the spot across an edge of that normal (unit).
  double SpotAcross(const Eigen::Vector2d& normal) const {
    return std::abs(normal.dot(spot_h)) + std::abs(normal.dot(spot_v));
  }
  /// How far beyond the true edge of that normal it is seen, and how much that varies.
  double GrownBy(const Eigen::Vector2d& normal) const { return beam.growth * SpotAcross(normal); }
  /// Variance of its distance to an edge of that normal.
  double VarianceAcross(const Eigen::Vector2d& normal) const {
    const double step = normal.dot(outward) * step_m;
    const double spot = beam.edge_sigma * SpotAcross(normal);
    return step * step / 12.0 + spot * spot;
  }
};

struct EdgeOptions {
  bool hollow = false;  ///< Gaps within a ring are edges of the opening.
  bool correct = true;  ///< Off: the last return itself, as the paper takes it, nothing taken off.
  LidarBeam beam{};
};

/// What the edge points of one side leave open together: rings that cross an edge all at the same
/// place between two samples tell it no better than one does. `Add` takes the signed distance of
/// each from the side and half its step across the side; the side may be moved by Variance() more.
class SharedStep {
 public:
  void Add(double distance_m, double half_step_m) {
    low_ = std::max(low_, distance_m - half_step_m);
    high_ = std::min(high_, distance_m + half_step_m);
  }
  /// Of a side's offset that is uniform over what all its points allow [m^2].
  double Variance() const {
    const double open = high_ - low_;
    return open > 0.0 && std::isfinite(open) ? open * open / 12.0 : 0.0;
  }

 private:
  double low_ = -std::numeric_limits<double>::infinity();
  double high_ = std::numeric_limits<double>::infinity();
};

/// Sets the spot of an edge point whose last return is `ray`.
void SetSpot(const LidarPlane& plane, const Eigen::Vector3d& ray, const EdgeOptions& options,
             EdgePoint& edge);

/// First and last return of each ring among the plane's points, and the middles of the highest and
/// lowest ring, where the edge lies before the next one. Edges that something nearer hides are left
/// out. Without rings: FindEdgePairs. `on_plane`: places within scan.points(), ascending.
std::vector<EdgePoint> FindEdgePoints(const ScanRings& scan, const LidarPlane& plane,
                                      std::span<const std::size_t> on_plane,
                                      const EdgeOptions& options);

}  // namespace sextant
