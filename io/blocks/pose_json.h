// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "geometry/rigid3d.h"

namespace sextant {

/// A pose as every JSON file of this project has it: {"matrix" (4 rows of 4), "translation_m",
/// "quaternion_wxyz", "euler_zyx_deg" (yaw, pitch, roll)}.
nlohmann::ordered_json PoseJson(const Rigid3d& pose);

}  // namespace sextant
