// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <span>

#include "io/cameras/camera_file.h"
#include "io/text/yaml_text.h"

namespace sextant {
namespace {

// How ROS names the distortion, and how many coefficients it then has.
struct RosModel {
  const char* name;
  std::size_t coefficients;
};

RosModel RosModelOf(const Camera& camera) {
  if (camera.model == CameraModel::kEquidistant) return {"equidistant", 4};
  const bool is_rational = std::any_of(camera.distortion.begin() + 5, camera.distortion.end(),
                                       [](double k) { return k != 0.0; });
  if (is_rational) return {"rational_polynomial", 8};
  return {"plumb_bob", 5};
}

void WriteMatrix(YamlText& out, const char* key, int rows, int columns,
                 std::span<const double> values) {
  out.Line("{}:", key);
  out.Line("  rows: {}", rows);
  out.Line("  cols: {}", columns);
  out.Line("  data: {}", YamlList(values));
}

}  // namespace

std::string FormatCameraInfo(const Camera& camera, const std::string& name) {
  const double k[] = {camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
  const double identity[] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  const double projection[] = {
      camera.fx_px, 0, camera.cx_px, 0, 0, camera.fy_px, camera.cy_px, 0, 0, 0, 1, 0};
  const RosModel model = RosModelOf(camera);
  YamlText out;
  out.Line("image_width: {}", camera.width_px);
  out.Line("image_height: {}", camera.height_px);
  out.Line("camera_name: {}", name);
  WriteMatrix(out, "camera_matrix", 3, 3, k);
  out.Line("distortion_model: {}", model.name);
  WriteMatrix(out, "distortion_coefficients", 1, static_cast<int>(model.coefficients),
              std::span(camera.distortion).first(model.coefficients));
  WriteMatrix(out, "rectification_matrix", 3, 3, identity);
  WriteMatrix(out, "projection_matrix", 3, 4, projection);
  return out.Take();
}

}  // namespace sextant
