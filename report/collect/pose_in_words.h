// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "geometry/rigid3d.h"

namespace sextant {

/// "The camera is 82 mm behind, 105 mm to the right of and 75 mm below the LiDAR. It looks forward,
/// 1.1 deg to the left and 2.0 deg up, ...": directions are those of the LiDAR (x forward, y left,
/// z up).
std::string PoseInWords(const Rigid3d& cam_from_lidar);

}  // namespace sextant
