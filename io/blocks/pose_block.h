// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#include "geometry/rigid3d.h"
#include "io/text/yaml_fields.h"

namespace sextant {

/// Reads a pose as every file of this project states it: a map with translation_m and
/// quaternion_wxyz (unit length to 1e-5), or with matrix (four rows of four). Errors go to `in` and
/// name the pose `what`. WriteYamlPose writes the first form.
Rigid3d ReadPoseBlock(YamlFields& in, const YamlNode& node, std::string_view what);

}  // namespace sextant
