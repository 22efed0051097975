// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/stereo_cloud.h"

#include <fmt/core.h>

#include <cmath>
#include <opencv2/calib3d.hpp>

#include "base/random.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

Expected<void> CheckOptions(const StereoOptions& options) {
  const bool is_fine = options.nearest_m > 0.0 && options.farthest_m > options.nearest_m &&
                       options.block_px > 0 && options.block_px % 2 == 1 &&
                       std::isfinite(options.farthest_m);
  if (is_fine) return {};
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("expected distances that ascend and an odd block, got {} to {} m, {} px",
                  options.nearest_m, options.farthest_m, options.block_px));
}

// Disparities in pixels, CV_32F; zero or negative where there is no match.
cv::Mat MatchImages(const cv::Mat& left, const cv::Mat& right, int most_px, int block_px) {
  // Smoothness penalties from OpenCV's documentation for one channel.
  const int small_step = 8 * block_px * block_px;
  const int large_step = 32 * block_px * block_px;
  const auto matcher =
      cv::StereoSGBM::create(0, most_px, block_px, small_step, large_step, /*disp12MaxDiff=*/1,
                             /*preFilterCap=*/31, /*uniquenessRatio=*/10,
                             /*speckleWindowSize=*/100, /*speckleRange=*/1);
  cv::Mat sixteenths;
  matcher->compute(left, right, sixteenths);
  cv::Mat disparities;
  sixteenths.convertTo(disparities, CV_32F, 1.0 / 16.0);
  return disparities;
}

// Both cameras as pinholes with the camera's focal length.
Expected<Scene> RectifiedPair(const Scene& scene, int camera_index, double baseline_m) {
  if (camera_index < 0 || camera_index >= static_cast<int>(scene.cameras.size())) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the scene '{}' has {} cameras, counted from 0; there is no {}",
                                 scene.name, scene.cameras.size(), camera_index));
  }
  SceneCamera left = scene.cameras[static_cast<std::size_t>(camera_index)];
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, RenderingCamera(left));
  left.model.clear();
  left.intrinsics = camera;
  left.intrinsics.model = CameraModel::kPinhole;
  left.intrinsics.distortion.fill(0.0);
  left.intrinsics.skew_px = left.intrinsics.xi = left.intrinsics.alpha = 0.0;
  left.assumed_intrinsics.reset();
  Scene pair = scene;
  pair.cameras = {left, StereoPartner(left, baseline_m, left.name + "_right")};
  return pair;
}

}  // namespace

Expected<StereoImages> RenderStereo(const Scene& scene, int camera_index, double baseline_m,
                                    const ImageOptions& image) {
  if (!(baseline_m > 0.0) || !std::isfinite(baseline_m)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("expected a positive baseline, got {} m", baseline_m));
  }
  SEXTANT_ASSIGN_OR_RETURN(const Scene pair, RectifiedPair(scene, camera_index, baseline_m));
  ImageOptions right_image = image;
  right_image.seed = DeriveSeed(image.seed, "stereo: right image", 0, 0);
  SEXTANT_ASSIGN_OR_RETURN(cv::Mat left, RenderImage(pair, 0, image));
  SEXTANT_ASSIGN_OR_RETURN(cv::Mat right, RenderImage(pair, 1, right_image));
  return StereoImages{left, right, pair.cameras[0].intrinsics, baseline_m};
}

std::optional<Eigen::Vector3d> Triangulate(const StereoImages& images, const Eigen::Vector2d& left,
                                           const Eigen::Vector2d& right) {
  const Camera& camera = images.camera;
  const double disparity = left.x() - right.x();
  if (!(disparity > 0.0)) return std::nullopt;
  const double depth = camera.fx_px * images.baseline_m / disparity;
  return Eigen::Vector3d((left.x() - camera.cx_px) / camera.fx_px * depth,
                         (left.y() - camera.cy_px) / camera.fy_px * depth, depth);
}

Expected<PointCloud> MatchStereo(const StereoImages& images, const StereoOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckOptions(options));
  const double depth_times_px = images.camera.fx_px * images.baseline_m;
  const int most_px = 16 * static_cast<int>(std::ceil(depth_times_px / options.nearest_m / 16.0));
  const cv::Mat disparities = MatchImages(images.left, images.right, most_px, options.block_px);
  PointCloud cloud;
  for (int row = 0; row < disparities.rows; ++row) {
    for (int column = 0; column < disparities.cols; ++column) {
      const double disparity = disparities.at<float>(row, column);
      if (!(disparity >= depth_times_px / options.farthest_m)) continue;
      const Eigen::Vector2d left(column, row);
      cloud.points.push_back(*Triangulate(images, left, left - Eigen::Vector2d(disparity, 0.0)));
      cloud.intensity.push_back(static_cast<float>(images.left.at<unsigned char>(row, column)));
    }
  }
  return cloud;
}

}  // namespace sextant
