// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_parts.h"

#include <fmt/core.h>

#include <algorithm>
#include <optional>

#include "io/text/number_text.h"

namespace sextant {
namespace {

using Names = std::span<const std::string_view>;

bool IsOneOf(std::string_view name, Names names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

// The sphere models, under the names that programs use for them; none for others.
std::optional<CameraModel> SphereModel(std::string_view name) {
  static constexpr std::string_view kOmnidirectional[] = {"omnidirectional", "omnidir", "omni",
                                                          "mei", "unified"};
  static constexpr std::string_view kDoubleSphere[] = {"double_sphere", "ds"};
  if (IsOneOf(name, kOmnidirectional)) return CameraModel::kOmnidirectional;
  if (IsOneOf(name, kDoubleSphere)) return CameraModel::kDoubleSphere;
  return std::nullopt;
}

Expected<CameraModel> CheckSphereCount(CameraModel model, std::size_t count) {
  const bool of_plane = model == CameraModel::kOmnidirectional;
  if (of_plane ? count <= 5 : count == 0) return model;
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("expected {}, got {} distortion coefficients",
                               of_plane ? "at most k1 k2 p1 p2 k3 for the omnidirectional model"
                                        : "xi and alpha alone for the double-sphere model",
                               count));
}

Expected<CameraModel> ModelOf(const CameraParts& parts) {
  const std::size_t count = parts.distortion.size();
  if (const auto sphere = SphereModel(parts.model)) return CheckSphereCount(*sphere, count);
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
                                 "fisheye, equidistant, omnidirectional or double_sphere, got {}",
                                 Quoted(parts.model)));
  }
  const bool all_zero = std::all_of(parts.distortion.begin(), parts.distortion.end(),
                                    [](double k) { return k == 0.0; });
  if (all_zero && parts.matrix[1] == 0.0) return CameraModel::kPinhole;
  if (all_zero || (count >= 4 && count <= kMaxDistortion)) return CameraModel::kBrownConrady;
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("expected 4 to {} distortion coefficients (of k1 k2 p1 p2 k3 k4 k5 "
                               "k6 s1 s2 s3 s4 tau_x tau_y, the others are 0), got {}",
                               kMaxDistortion, count));
}

}  // namespace

RosDistortion RosDistortionOf(const Camera& camera) {
  if (camera.model == CameraModel::kEquidistant) return {"equidistant", 4};
  if (camera.model == CameraModel::kOmnidirectional) return {"omnidirectional", 5};
  if (camera.model == CameraModel::kDoubleSphere) return {"double_sphere", 0};
  const auto any_from = [&](std::ptrdiff_t first) {
    return std::any_of(camera.distortion.begin() + first, camera.distortion.end(),
                       [](double k) { return k != 0.0; });
  };
  if (any_from(8)) return {"rational_polynomial", kMaxDistortion};
  if (any_from(5)) return {"rational_polynomial", 8};
  return {"plumb_bob", 5};
}

Expected<Camera> CameraFromParts(const CameraParts& parts) {
  const std::array<double, 9>& k = parts.matrix;
  if (k[3] != 0.0 || k[6] != 0.0 || k[7] != 0.0 || k[8] != 1.0) {
    return MakeError(ErrorCode::kInvalidInput,
                     "expected a camera matrix fx skew cx 0 fy cy 0 0 1, row by row");
  }
  SEXTANT_ASSIGN_OR_RETURN(const CameraModel model, ModelOf(parts));
  Camera camera;
  camera.model = model;
  camera.width_px = parts.width_px;
  camera.height_px = parts.height_px;
  camera.fx_px = k[0];
  camera.skew_px = k[1];
  camera.fy_px = k[4];
  camera.cx_px = k[2];
  camera.cy_px = k[5];
  camera.xi = parts.xi;
  camera.alpha = parts.alpha;
  if (camera.model != CameraModel::kPinhole) {
    const std::size_t count = std::min(parts.distortion.size(), camera.distortion.size());
    std::copy_n(parts.distortion.begin(), count, camera.distortion.begin());
  }
  SEXTANT_RETURN_IF_ERROR(ValidateCamera(camera));
  return camera;
}

}  // namespace sextant
