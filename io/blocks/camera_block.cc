// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/camera_block.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include "geometry/intrinsics.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// In the order of CameraModel.
constexpr std::array<std::string_view, 5> kModelNames = {"pinhole", "brown_conrady", "equidistant",
                                                         "omnidirectional", "double_sphere"};

}  // namespace

std::string_view CameraModelName(CameraModel model) {
  return kModelNames[static_cast<std::size_t>(model)];
}

std::optional<CameraModel> CameraModelNamed(std::string_view name) {
  const auto found = std::find(kModelNames.begin(), kModelNames.end(), name);
  if (found == kModelNames.end()) return std::nullopt;
  return static_cast<CameraModel>(found - kModelNames.begin());
}

Camera ReadCameraBlock(YamlFields& in, const YamlNode& node) {
  static const std::vector<std::string> kKeys = {"model",   "width_px", "height_px", "fx_px",
                                                 "fy_px",   "cx_px",    "cy_px",     "distortion",
                                                 "skew_px", "xi",       "alpha"};
  Camera camera;
  if (!in.IsMap(node, "camera", kKeys)) return camera;
  const std::string model = in.TextAt(node, "model");
  if (const std::optional<CameraModel> named = CameraModelNamed(model)) {
    camera.model = *named;
  } else {
    in.Fail(node.line, "model",
            fmt::format("expected {}, got {}", fmt::join(kModelNames, " or "), Quoted(model)));
  }
  constexpr int kMaxPixels = 1'000'000;
  if (node.Find("width_px") != nullptr)
    camera.width_px = in.IntegerAt(node, "width_px", 0, kMaxPixels);
  if (node.Find("height_px") != nullptr)
    camera.height_px = in.IntegerAt(node, "height_px", 0, kMaxPixels);
  camera.fx_px = in.RealAt(node, "fx_px");
  camera.fy_px = in.RealAt(node, "fy_px");
  camera.cx_px = in.RealAt(node, "cx_px");
  camera.cy_px = in.RealAt(node, "cy_px");
  camera.skew_px = in.RealAt(node, "skew_px", 0.0);
  camera.xi = in.RealAt(node, "xi", 0.0);
  camera.alpha = in.RealAt(node, "alpha", 0.0);
  if (const YamlNode* list = node.Find("distortion")) {
    const std::vector<double> values = in.RealList(*list, "distortion", camera.distortion.size());
    std::copy(values.begin(), values.end(), camera.distortion.begin());
  }
  if (!in.ok()) return camera;
  if (const Expected<void> valid = ValidateCamera(camera); !valid) {
    in.Fail(node.line, "camera", valid.error().message);
  }
  return camera;
}

void WriteCameraBlock(YamlText& out, const Camera& camera) {
  out.Line("camera:");
  WriteCameraKeys(out, "  ", camera);
}

void WriteCameraKeys(YamlText& out, const std::string& indent, const Camera& camera) {
  out.Line("{}model: {}", indent, CameraModelName(camera.model));
  out.Line("{}width_px: {}", indent, camera.width_px);
  out.Line("{}height_px: {}", indent, camera.height_px);
  out.Line("{}fx_px: {}", indent, camera.fx_px);
  out.Line("{}fy_px: {}", indent, camera.fy_px);
  out.Line("{}cx_px: {}", indent, camera.cx_px);
  out.Line("{}cy_px: {}", indent, camera.cy_px);
  out.Line("{}distortion: {}", indent, YamlList(WrittenDistortion(camera)));
  if (camera.skew_px != 0.0) out.Line("{}skew_px: {}", indent, camera.skew_px);
  if (camera.xi != 0.0) out.Line("{}xi: {}", indent, camera.xi);
  if (camera.alpha != 0.0) out.Line("{}alpha: {}", indent, camera.alpha);
}

}  // namespace sextant
