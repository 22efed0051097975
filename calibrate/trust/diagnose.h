// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// Contradictions between the measurements and the board file, the intrinsics or the session, one
/// line each with figures and advice: sizes of boards in the scans, distances that are too long or
/// too short in the images, prints that the camera model does not fit, views that repeat each other
/// or are too few. Empty where there are none.
std::vector<std::string> Diagnose(std::span<const SessionView> views, const Assembly& assembly,
                                  const Rigid3d& cam_from_lidar);

}  // namespace sextant
