// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "report/projected_scan.h"

namespace sextant::cli {

/// How far apart the samples of a scan are in the picture.
struct SampleSpacing {
  double across_px = 1.0;
  double down_px = 1.0;
};

/// Which of the returns something nearer hides from the camera, though the LiDAR saw them: the
/// sensors stand apart. A return counts as hidden where others, nearer to the camera by a tenth and
/// 0.2 m, surround it: in three of its four quadrants within two samples. One beside an edge is
/// not.
std::vector<bool> HiddenReturns(const std::vector<ProjectedReturn>& returns,
                                const SampleSpacing& spacing);

}  // namespace sextant::cli
