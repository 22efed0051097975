// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_parts.h"

#include <fmt/core.h>

#include <algorithm>

#include "io/text/number_text.h"

namespace sextant {
namespace {

Expected<CameraModel> ModelOf(const CameraParts& parts) {
  const std::size_t count = parts.distortion.size();
  if (parts.model == "fisheye" || parts.model == "equidistant") {
    if (count == 4) return CameraModel::kEquidistant;
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("expected 4 distortion coefficients k1..k4 for the {} model, got "
                                 "{}",
                                 parts.model, count));
  }
  if (!parts.model.empty() && parts.model != "plumb_bob" && parts.model != "rational_polynomial") {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("expected the distortion model plumb_bob, rational_polynomial, "
                                 "fisheye or equidistant, got {}",
                                 Quoted(parts.model)));
  }
  const bool all_zero = std::all_of(parts.distortion.begin(), parts.distortion.end(),
                                    [](double k) { return k == 0.0; });
  if (all_zero) return CameraModel::kPinhole;
  // The coefficients from the ninth on are OpenCV's thin prism and tilt, almost always zero.
  const auto beyond = parts.distortion.subspan(std::min<std::size_t>(8, count));
  if (count >= 4 && std::all_of(beyond.begin(), beyond.end(), [](double k) { return k == 0.0; })) {
    return CameraModel::kBrownConrady;
  }
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("expected 4, 5 or 8 distortion coefficients (k1 k2 p1 p2 k3 k4 k5 "
                               "k6), got {}{}",
                               count, count > 8 ? " with thin prism or tilt terms" : ""));
}

}  // namespace

RosDistortion RosDistortionOf(const Camera& camera) {
  if (camera.model == CameraModel::kEquidistant) return {"equidistant", 4};
  const bool is_rational = std::any_of(camera.distortion.begin() + 5, camera.distortion.end(),
                                       [](double k) { return k != 0.0; });
  if (is_rational) return {"rational_polynomial", 8};
  return {"plumb_bob", 5};
}

Expected<Camera> CameraFromParts(const CameraParts& parts) {
  const std::array<double, 9>& k = parts.matrix;
  if (k[1] != 0.0 || k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    return MakeError(ErrorCode::kInvalidInput,
                     "expected a camera matrix fx 0 cx 0 fy cy 0 0 1 (without skew)");
  }
  SEXTANT_ASSIGN_OR_RETURN(const CameraModel model, ModelOf(parts));
  Camera camera;
  camera.model = model;
  camera.width_px = parts.width_px;
  camera.height_px = parts.height_px;
  camera.fx_px = k[0];
  camera.fy_px = k[4];
  camera.cx_px = k[2];
  camera.cy_px = k[5];
  if (camera.model != CameraModel::kPinhole) {
    const std::size_t count = std::min(parts.distortion.size(), camera.distortion.size());
    std::copy_n(parts.distortion.begin(), count, camera.distortion.begin());
  }
  SEXTANT_RETURN_IF_ERROR(ValidateCamera(camera));
  return camera;
}

}  // namespace sextant
