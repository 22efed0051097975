// SPDX-License-Identifier: Apache-2.0
#include "features/scene/scan_sweeps.h"

#include "features/lidar/rings/scan_rings.h"

namespace sextant {

Expected<ScanSweeps> FindSweeps(const PointCloud& scan) {
  constexpr double kMinRange_m = 0.5;
  SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(scan));
  ScanSweeps sweeps;
  for (int i = 0; i < rings.rings(); ++i) {
    std::vector<int>& sweep = sweeps.emplace_back();
    for (const RingPoint& point : rings.ring(i)) {
      if (point.range_m >= kMinRange_m) sweep.push_back(point.index);
    }
  }
  return sweeps;
}

}  // namespace sextant
