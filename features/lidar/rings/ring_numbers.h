// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace sextant {

/// What is known of a return before it belongs to a ring.
struct UnsortedReturn {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< Unit, in the LiDAR frame.
  double range_m = 0.0;
  std::size_t index = 0;  ///< Index into the cloud.
};

/// Ring numbers of returns, and the axis about which the sensor turns.
struct RingNumbers {
  std::vector<int> of_return{};  ///< One per return; empty if the scan has no rings.
  Eigen::Vector3d axis = Eigen::Vector3d::UnitZ();  ///< Unit, in the LiDAR frame.
  bool ascend = false;  ///< Whether numbers are known to ascend with elevation.
};

/// Checks ring numbers of a file: each must be one elevation about a common axis. The axis is z
/// unless another one fits clearly better, as in a cloud that was rotated into a vehicle's frame.
/// Without rings if no axis fits, as for the line numbers of a rosette.
RingNumbers CheckRings(std::span<const UnsortedReturn> returns, std::vector<int> numbers);

/// Recovers the rings of a scan without ring numbers, by the first of these that succeeds:
/// 1. elevations that repeat exactly, as for beams that start at the origin;
/// 2. the order of the points: an organised cloud (one row per ring or per column), or returns that
///    are listed ring by ring in each column, where invalid returns keep their place;
/// 3. whole turns that follow each other in the order of elevation (ring_turns.h), as in KITTI's
///    files, however wide the rings are;
/// 4. elevations that change slowly from far returns to near ones, as for beams that start beside
///    the origin, or along the azimuth, as for mirrors that tilt the fan.
/// `returns` are in the order of the cloud; `cloud_size` includes invalid points. Time: O(n (log n
/// + rings)).
RingNumbers RecoverRings(std::span<const UnsortedReturn> returns, std::size_t cloud_size);

}  // namespace sextant
