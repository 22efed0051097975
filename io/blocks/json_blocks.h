// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "geometry/board.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A pose as in every JSON file of this project: {"matrix" (4 rows of 4), "translation_m",
/// "quaternion_wxyz", "euler_zyx_deg" (yaw, pitch, roll)}.
nlohmann::ordered_json PoseJson(const Rigid3d& pose);

/// All keys of the map `camera` of a problem file (io/blocks/camera_block.h).
nlohmann::ordered_json CameraJson(const Camera& camera);

/// The keys of a board file (io/blocks/board_block.h); absent parts have no key.
nlohmann::ordered_json BoardJson(const Board& board);

}  // namespace sextant
