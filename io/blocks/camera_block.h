// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/camera.h"
#include "io/text/yaml_fields.h"
#include "io/text/yaml_text.h"

namespace sextant {

/// "pinhole", "brown_conrady", "equidistant", "omnidirectional" or "double_sphere".
std::string_view CameraModelName(CameraModel model);
std::optional<CameraModel> CameraModelNamed(std::string_view name);

/// Reads the map `camera` of problem and result files, with the keys model, width_px, height_px,
/// fx_px, fy_px, cx_px, cy_px, distortion, skew_px, xi and alpha, and validates it. Errors go to
/// `in`.
Camera ReadCameraBlock(YamlFields& in, const YamlNode& node);

/// Writes "camera:" and the lines of its keys.
void WriteCameraBlock(YamlText& out, const Camera& camera);
/// Writes the lines of the keys, each after `indent`.
void WriteCameraKeys(YamlText& out, const std::string& indent, const Camera& camera);

}  // namespace sextant
