// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "features/lidar/lidar_plane.h"
#include "features/lidar/rings/scan_rings.h"

namespace sextant {

enum class RayEnd : std::uint8_t { kOnPlane, kBehind, kInFront };

/// Where a ray of the scan meets a plane, and where it ends.
struct PlaneRay {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< In the plane's axes [m].
  int ring = 0;
  RayEnd end = RayEnd::kOnPlane;
};

/// The rays that meet a plane around a point of it.
struct PlaneRays {
  std::vector<PlaneRay> rays{};
  double azimuth_step_m = 0.0;  ///< Distance of neighbouring rays there, across the line of sight.
  Eigen::Vector2d ring_direction = Eigen::Vector2d::UnitX();  ///< Unit, along the rings.
  /// From a ring to the next one up, in the plane [m].
  Eigen::Vector2d to_next_ring = Eigen::Vector2d::UnitY();
};

/// Collects the rays that meet the plane within `reach_m` of `center` (in the plane's axes). Rays
/// without a return are absent. Time: proportional to the returns in the azimuths of that circle.
PlaneRays RaysAround(const ScanRings& scan, const LidarPlane& plane, const Eigen::Vector2d& center,
                     double reach_m);

}  // namespace sextant
