// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "geometry/camera.h"
#include "io/text/yaml_fields.h"
#include "io/text/yaml_text.h"

namespace sextant {

/// A camera in the files of this project: the block `camera:` of a problem, and results.

/// "pinhole", "brown_conrady" or "equidistant".
std::string_view CameraModelName(CameraModel model);
std::optional<CameraModel> CameraModelNamed(std::string_view name);

/// The map with keys model, width_px, height_px, fx_px, fy_px, cx_px, cy_px and distortion;
/// validated. Errors go to `in`.
Camera ReadCameraBlock(YamlFields& in, const YamlNode& node);

/// The lines of the block, from "camera:" on.
void WriteCameraBlock(YamlText& out, const Camera& camera);
/// The lines of its keys, each after `indent`.
void WriteCameraKeys(YamlText& out, const std::string& indent, const Camera& camera);

}  // namespace sextant
