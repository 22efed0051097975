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
  double turn_deg = 5.0;  ///< Rotation between the scans, about a random axis.
  double move_m = 0.1;    ///< Translation between the scans, in a random direction.
  ScanOptions scan{};     ///< `seed` and `scan_index` are ignored.
};

/// Two scans of the same room by the same LiDAR unit from two places.
struct ScanPair {
  std::vector<Eigen::Vector3d> in_target;  ///< Metres.
  std::vector<Eigen::Vector3d> in_source;
  Rigid3d target_from_source;
};

/// Two scans of a random FurnishedRoom. Errors: those of SimulateScan.
Expected<ScanPair> ScanRoomTwice(const LidarModel& model, std::uint64_t seed,
                                 const ScanPairOptions& options = {});

/// Two scans of any scene; the LiDAR starts at the world's origin.
Expected<ScanPair> ScanTwice(Scene scene, const LidarModel& model, std::uint64_t seed,
                             const ScanPairOptions& options = {});

}  // namespace sextant
