// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "base/error.h"
#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "simulator/camera/render.h"

namespace sextant {

/// Options of the stereo matcher.
struct StereoOptions {
  double nearest_m = 0.8;   ///< Determines the largest disparity that is searched.
  double farthest_m = 6.0;  ///< Farther points are left out: their depth is too uncertain.
  int block_px = 5;
};

/// Rectified images of the left and the right camera.
struct StereoImages {
  cv::Mat left;
  cv::Mat right;
  Camera camera{};  ///< Intrinsics of both: a pinhole with the model's focal length.
  double baseline_m = 0.0;
};

/// Renders images of the scene's camera and of a second one `baseline_m` along its x axis
/// (RenderImage), without distortion like the rectified images of stereo cameras. Errors: those of
/// RenderImage; kInvalidInput for a baseline that is not positive.
Expected<StereoImages> RenderStereo(const Scene& scene, int camera_index, double baseline_m,
                                    const ImageOptions& image);

/// Triangulated points where both images match: OpenCV's semi-global matching (Hirschmueller 2008)
/// with left-right check and speckle filter. Points [m] in the left camera's frame, row by row,
/// with grey levels as intensity. Only textured surfaces give points: see SceneWall::speckled.
/// Errors: kInvalidInput for options that are not positive.
Expected<PointCloud> MatchStereo(const StereoImages& images, const StereoOptions& options);

/// The point [m] in the left camera's frame of a pixel in both images; none if the disparity is not
/// positive.
std::optional<Eigen::Vector3d> Triangulate(const StereoImages& images, const Eigen::Vector2d& left,
                                           const Eigen::Vector2d& right);

}  // namespace sextant
