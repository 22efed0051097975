// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "geometry/camera.h"

namespace sextant {

/// The keys of the block `camera` of a problem file (io/blocks/camera_block.h), all of them.
nlohmann::ordered_json CameraJson(const Camera& camera);

}  // namespace sextant
