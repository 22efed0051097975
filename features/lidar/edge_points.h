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
#include "features/lidar/rings/scan_rings.h"

namespace sextant {

/// The point in the board's plane at which the samples of a ring leave the board.
///
/// The true edge lies between the last return on the board and the first beyond it, so its position
/// along the ring is uniform over one step; the estimate is the middle. A ray's angles are known
/// far more precisely than its range, so positions are intersections of rays with the plane. The
/// effect of the beam's width depends on the direction of the edge; users who know it subtract
/// Growth().
struct EdgePoint {
  Eigen::Vector2d in_plane = Eigen::Vector2d::Zero();  ///< Apparent position of the edge [m].
  Eigen::Vector2d outward = Eigen::Vector2d::UnitX();  ///< Unit, along the ring, off the board.
  double step_m = 0.0;                                 ///< Distance of neighbouring samples there.
  Eigen::Vector2d spot_h = Eigen::Vector2d::Zero();  ///< Width of the beam's spot in the plane [m].
  Eigen::Vector2d spot_v = Eigen::Vector2d::Zero();  ///< Height of the spot.
  LidarBeam beam{};
  bool across = false;  ///< Between two rings, at the board's upper or lower end.
  bool inner = false;   ///< On a hollow board's opening.
  int ring = 0;
  Eigen::Vector3d last_return = Eigen::Vector3d::Zero();  ///< As measured, uncorrected [m].

  /// Width of the spot across an edge with that normal (unit).
  double SpotAcross(const Eigen::Vector2d& normal) const {
    return std::abs(normal.dot(spot_h)) + std::abs(normal.dot(spot_v));
  }
  /// Distance of the apparent edge beyond the true one with that normal.
  double Growth(const Eigen::Vector2d& normal) const { return beam.growth * SpotAcross(normal); }
  /// Variance of the distance to an edge with that normal.
  double VarianceAcross(const Eigen::Vector2d& normal) const {
    const double step = normal.dot(outward) * step_m;
    const double spot = beam.edge_sigma * SpotAcross(normal);
    return step * step / 12.0 + spot * spot;
  }
};

struct EdgeOptions {
  bool hollow = false;  ///< Whether gaps within a ring are edges of the opening.
  bool correct = true;  ///< If false, edge points are the last returns themselves, as in the paper.
  LidarBeam beam{};
};

/// The uncertainty that all edge points of one side share: if all rings cross an edge at the same
/// phase between two samples, they constrain it no better than one ring does. `Add` takes the
/// signed distance of each point from the side and half its step across the side.
class SharedStep {
 public:
  void Add(double distance_m, double half_step_m) {
    low_ = std::max(low_, distance_m - half_step_m);
    high_ = std::min(high_, distance_m + half_step_m);
  }
  /// Variance [m^2] of the side's offset, uniform over the interval that all points allow.
  double Variance() const {
    const double open = high_ - low_;
    return open > 0.0 && std::isfinite(open) ? open * open / 12.0 : 0.0;
  }

 private:
  double low_ = -std::numeric_limits<double>::infinity();
  double high_ = std::numeric_limits<double>::infinity();
};

/// The same for the side's direction: if neighbouring rings cross an edge at nearly the same phase,
/// as an edge along the columns, the points constrain its slope no better than two of them do.
/// `Add` takes the position along the side, too. Time: O(n^2) in the number of points.
class SharedSlope {
 public:
  void Add(double along_m, double distance_m, double half_step_m) {
    places_.push_back({along_m, distance_m, half_step_m});
  }
  /// Variance of the slope, uniform over the interval that all points allow.
  double Variance() const;

 private:
  struct Place {
    double along = 0.0;
    double distance = 0.0;
    double half_step = 0.0;
  };
  std::vector<Place> places_{};
};

/// Sets the beam and the spot of an edge point whose last return is `ray`.
void SetSpot(const ScanRings& scan, const LidarPlane& plane, const Eigen::Vector3d& ray,
             const EdgeOptions& options, EdgePoint& edge);

/// Edge points where a ring enters and leaves the plane's points, and at the middles of the highest
/// and lowest ring, beyond which the edge lies before the next ring. There are none where a nearer
/// object hides the edge, or where the ring's next return is on the plane, too. Without rings:
/// FindEdgePairs. `on_plane`: indices into scan.points(), ascending.
std::vector<EdgePoint> FindEdgePoints(const ScanRings& scan, const LidarPlane& plane,
                                      std::span<const std::size_t> on_plane,
                                      const EdgeOptions& options);

}  // namespace sextant
