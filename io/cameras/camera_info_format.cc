// SPDX-License-Identifier: Apache-2.0
#include <span>

#include "base/text/escape.h"
#include "io/cameras/camera_file.h"
#include "io/cameras/camera_parts.h"
#include "io/text/yaml_text.h"

namespace sextant {
namespace {

void WriteMatrix(YamlText& out, const char* key, int rows, int columns,
                 std::span<const double> values) {
  out.Line("{}:", key);
  out.Line("  rows: {}", rows);
  out.Line("  cols: {}", columns);
  out.Line("  data: {}", YamlList(values));
}

}  // namespace

std::string FormatCameraInfo(const Camera& camera, const std::string& name) {
  const double k[] = {
      camera.fx_px, camera.skew_px, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
  const double identity[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double projection[] = {
      camera.fx_px, camera.skew_px, camera.cx_px, 0, 0, camera.fy_px, camera.cy_px, 0, 0, 0, 1, 0};
  const RosDistortion distortion = RosDistortionOf(camera);
  YamlText out;
  out.Line("image_width: {}", camera.width_px);
  out.Line("image_height: {}", camera.height_px);
  out.Line("camera_name: {}", YamlQuoted(name));
  WriteMatrix(out, "camera_matrix", 3, 3, k);
  out.Line("distortion_model: {}", distortion.model);
  if (camera.model == CameraModel::kOmnidirectional) out.Line("xi: {}", camera.xi);
  if (camera.model == CameraModel::kDoubleSphere) {
    out.Line("xi: {}", camera.xi);
    out.Line("alpha: {}", camera.alpha);
  }
  WriteMatrix(out, "distortion_coefficients", 1, static_cast<int>(distortion.coefficients),
              std::span(camera.distortion).first(distortion.coefficients));
  WriteMatrix(out, "rectification_matrix", 3, 3, identity);
  WriteMatrix(out, "projection_matrix", 3, 4, projection);
  return out.Take();
}

}  // namespace sextant
