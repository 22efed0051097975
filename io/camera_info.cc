// SPDX-License-Identifier: Apache-2.0
#include "io/camera_info.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <span>

#include "io/yaml_text.h"

namespace sextant {

std::string FormatCameraInfo(const Camera& camera, const std::string& name) {
  const bool is_fisheye = camera.model == CameraModel::kEquidistant;
  const bool is_rational =
      !is_fisheye && std::any_of(camera.distortion.begin() + 5, camera.distortion.end(),
                                 [](double k) { return k != 0.0; });
  const std::size_t count = is_fisheye ? 4 : is_rational ? 8 : 5;
  const char* model = is_fisheye    ? "equidistant"
                      : is_rational ? "rational_polynomial"
                                    : "plumb_bob";
  const std::span<const double> distortion(camera.distortion.data(), count);
  const std::array<double, 9> matrix = {
      camera.fx_px, 0, camera.cx_px, 0, camera.fy_px, camera.cy_px, 0, 0, 1};
  return fmt::format(
      "image_width: {}\nimage_height: {}\ncamera_name: {}\n"
      "camera_matrix: {{rows: 3, cols: 3, data: {}}}\ndistortion_model: {}\n"
      "distortion_coefficients: {{rows: 1, cols: {}, data: {}}}\n",
      camera.width_px, camera.height_px, YamlQuoted(name), YamlList(matrix), model, count,
      YamlList(distortion));
}

}  // namespace sextant
