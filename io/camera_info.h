// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "geometry/camera.h"

namespace sextant {

/// The camera as a camera_info YAML of ROS, which ReadCamera reads back to the same bits.
std::string FormatCameraInfo(const Camera& camera, const std::string& name);

}  // namespace sextant
