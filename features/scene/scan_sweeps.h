// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// Indices of a scan's returns, sweep by sweep, each in the order of its azimuths or the reverse.
/// Neighbouring sweeps are neighbours in elevation.
using ScanSweeps = std::vector<std::vector<int>>;

/// The sweeps of a scan: whole turns where the points are listed so (KITTI), else its rings or,
/// without rings, bands of elevation (features/lidar/rings/scan_rings.h). Returns nearer than 0.5 m
/// are omitted. Errors: those of ScanRings::Build. Time: O(n log n).
Expected<ScanSweeps> FindSweeps(const PointCloud& scan);

}  // namespace sextant
