// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/camera_model.h"

#include <fmt/core.h>

#include <array>

#include "base/nearest_name.h"

namespace sextant {
namespace {

struct CameraEntry {
  const char* name;
  Camera camera;
};

const std::array<CameraEntry, 4>& Models() {
  static const std::array<CameraEntry, 4> models = {{
      {"pinhole",
       {.model = CameraModel::kPinhole,
        .width_px = 1280,
        .height_px = 720,
        .fx_px = 700.0,
        .fy_px = 700.0,
        .cx_px = 639.5,
        .cy_px = 359.5}},
      {"zed_left",
       {.model = CameraModel::kBrownConrady,
        .width_px = 1280,
        .height_px = 720,
        .fx_px = 699.5,
        .fy_px = 699.5,
        .cx_px = 652.4,
        .cy_px = 358.1,
        .distortion = {-0.17, 0.023, 0.0004, -0.0003}}},
      {"point_grey",
       {.model = CameraModel::kBrownConrady,
        .width_px = 1288,
        .height_px = 964,
        .fx_px = 2133.0,
        .fy_px = 2133.0,
        .cx_px = 640.2,
        .cy_px = 485.7,
        .distortion = {-0.09, 0.12}}},
      {"fisheye",
       {.model = CameraModel::kEquidistant,
        .width_px = 1920,
        .height_px = 1208,
        .fx_px = 1176.93,
        .fy_px = 1177.72,
        .cx_px = 962.275,
        .cy_px = 612.725,
        .distortion = {-0.0540096, -0.0784275, 0.0959641, -0.0515253}}},
  }};
  return models;
}

Error Naming(const SceneCamera& camera, Error error) {
  return {error.code, fmt::format("camera '{}': {}", camera.name, error.message)};
}

Expected<Camera> Checked(const SceneCamera& scene_camera, const Camera& camera) {
  if (const Expected<void> ok = ValidateCamera(camera); !ok) {
    return tl::unexpected(Naming(scene_camera, ok.error()));
  }
  constexpr double kMaxPixels = 1e8;
  const double pixels = 1.0 * camera.width_px * camera.height_px;
  if (pixels >= 1.0 && pixels <= kMaxPixels) return camera;
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("camera '{}': an image of {} x {} px cannot be rendered, expected 1 "
                               "to {:.0f} pixels",
                               scene_camera.name, camera.width_px, camera.height_px, kMaxPixels));
}

}  // namespace

const std::vector<std::string>& CameraModelNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const CameraEntry& entry : Models()) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

Expected<Camera> FindCameraModel(std::string_view name) {
  for (const CameraEntry& entry : Models()) {
    if (name == entry.name) return entry.camera;
  }
  return MakeError(ErrorCode::kUnknownName, fmt::format("no camera model '{}'; {}", name,
                                                        SuggestName(name, CameraModelNames())));
}

Expected<Camera> RenderingCamera(const SceneCamera& camera) {
  if (camera.model.empty()) return Checked(camera, camera.intrinsics);
  const Expected<Camera> model = FindCameraModel(camera.model);
  if (!model) return tl::unexpected(Naming(camera, model.error()));
  return Checked(camera, *model);
}

Expected<Camera> PublishedCamera(const SceneCamera& camera) {
  return camera.assumed_intrinsics ? Checked(camera, *camera.assumed_intrinsics)
                                   : RenderingCamera(camera);
}

SceneCamera StereoPartner(const SceneCamera& left, double baseline_m, const std::string& name) {
  SceneCamera right = left;
  right.name = name;
  right.world_from_cam.translation = left.world_from_cam * Eigen::Vector3d(baseline_m, 0.0, 0.0);
  return right;
}

}  // namespace sextant
