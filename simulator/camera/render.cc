// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/render.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <vector>

#include "simulator/camera/area_sampler.h"
#include "simulator/camera/camera_view.h"
#include "simulator/camera/image_effects.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

struct Range {
  const char* name;
  double value;
  double low;
  double high;
};

Expected<void> CheckOptions(const ImageOptions& options) {
  constexpr double kMaxTime_s = 1e9;
  for (const Range& range : {
           Range{"time_s", options.time_s, -kMaxTime_s, kMaxTime_s},
           Range{"exposure", options.exposure, 1e-6, 1e6},
           Range{"blur_sigma_px", options.blur_sigma_px, 0.0, 100.0},
           Range{"vignetting", options.vignetting, 0.0, 1.0},
           Range{"noise_sigma_grey", options.noise_sigma_grey, 0.0, 255.0},
           Range{"shot_variance_grey", options.shot_variance_grey, 0.0, 255.0},
           Range{"jpeg_quality", 1.0 * options.jpeg_quality.value_or(1), 1.0, 100.0},
           Range{"lighting.ambient", options.lighting.ambient, 0.0, 1.0},
           Range{"length of lighting.lamp_in_world", options.lighting.lamp_in_world.norm(), 1e-6,
                 1e6},
       }) {
    if (range.value >= range.low && range.value <= range.high) continue;
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("image option {} is {}, expected {} to {}", range.name,
                                 range.value, range.low, range.high));
  }
  return {};
}

Expected<const SceneCamera*> FindCamera(const Scene& scene, int index) {
  const int count = static_cast<int>(scene.cameras.size());
  if (index >= 0 && index < count) return &scene.cameras[static_cast<std::size_t>(index)];
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("the scene '{}' has {} cameras, counted from 0; there is no {}",
                               scene.name, count, index));
}

}  // namespace

ImageOptions UsualImageOptions(std::uint64_t seed, double time_s) {
  return {.seed = seed,
          .time_s = time_s,
          .exposure = 1.15,
          .blur_sigma_px = 0.7,
          .vignetting = 0.25,
          .noise_sigma_grey = 2.0,
          .shot_variance_grey = 0.02};
}

Expected<cv::Mat> RenderImage(const Scene& scene, int camera_index, const ImageOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckOptions(options));
  SEXTANT_ASSIGN_OR_RETURN(const SceneCamera* scene_camera, FindCamera(scene, camera_index));
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, RenderingCamera(*scene_camera));
  SEXTANT_ASSIGN_OR_RETURN(
      const CameraView view,
      CameraView::Make(scene, scene_camera->world_from_cam, options.time_s, options.lighting));
  cv::Mat image = SampleAreas(camera, view);
  if (options.blur_sigma_px > 0.0) image = BlurGaussian(image, options.blur_sigma_px);
  if (options.vignetting > 0.0) Vignette(camera, options.vignetting, image);
  const cv::Mat grey = Expose(image, 255.0 * options.exposure,
                              {.read_sigma_grey = options.noise_sigma_grey,
                               .shot_variance_grey = options.shot_variance_grey,
                               .seed = options.seed,
                               .stream = static_cast<std::uint64_t>(camera_index)});
  return options.jpeg_quality ? ThroughJpeg(grey, *options.jpeg_quality) : grey;
}

Expected<SurfaceImage> RenderSurfaces(const Scene& scene, int camera_index, double time_s) {
  SEXTANT_RETURN_IF_ERROR(CheckOptions({.time_s = time_s}));
  SEXTANT_ASSIGN_OR_RETURN(const SceneCamera* scene_camera, FindCamera(scene, camera_index));
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, RenderingCamera(*scene_camera));
  SEXTANT_ASSIGN_OR_RETURN(
      const CameraView view,
      CameraView::Make(scene, scene_camera->world_from_cam, time_s, Lighting{}));
  std::vector<int> all;
  view.FindCandidates(Eigen::Vector3d::UnitZ(), std::acos(-1.0), all);
  SurfaceImage surfaces{cv::Mat::zeros(camera.height_px, camera.width_px, CV_64F),
                        cv::Mat::zeros(camera.height_px, camera.width_px, CV_64FC3)};
  tbb::parallel_for(0, camera.height_px, [&](int row) {
    for (int column = 0; column < camera.width_px; ++column) {
      const std::optional<Eigen::Vector3d> ray = Unproject(camera, {1.0 * column, 1.0 * row});
      if (!ray) continue;
      const Seen seen = view.Cast(*ray, all);
      if (seen.surface < 0) continue;
      surfaces.depth_m.at<double>(row, column) = ray->z() / seen.hit.inverse_range;
      const Eigen::Vector3d normal = view.NormalAt(seen, *ray);
      surfaces.normal_in_cam.at<cv::Vec3d>(row, column) = {normal.x(), normal.y(), normal.z()};
    }
  });
  return surfaces;
}

}  // namespace sextant
