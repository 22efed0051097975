// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant {

struct ScanPairOptions {
  double turn_deg = 5.0;  ///< Between the scans, about any axis.
  double move_m = 0.1;    ///< In any direction.
  ScanOptions scan{};     ///< Its seed and scan_index are not looked at.
};

/// Two scans by one unit of the same room, from two places.
struct ScanPair {
  std::vector<Eigen::Vector3d> in_target;  ///< Metres.
  std::vector<Eigen::Vector3d> in_source;
  Rigid3d target_from_source;
};

/// Of FurnishedRoom(seed). Errors: those of SimulateScan.
Expected<ScanPair> ScanRoomTwice(const LidarModel& model, std::uint64_t seed,
                                 const ScanPairOptions& options = {});

/// Of any scene with its LiDAR at the world's origin.
Expected<ScanPair> ScanTwice(Scene scene, const LidarModel& model, std::uint64_t seed,
                             const ScanPairOptions& options = {});

}  // namespace sextant
