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

/// What the matcher looks for.
struct StereoOptions {
  double nearest_m = 0.8;   ///< Sets the largest disparity that is searched.
  double farthest_m = 6.0;  ///< Farther points are left out: their depth is too uncertain.
  int block_px = 5;
};

/// What the left and the right eye see, rectified.
struct StereoImages {
  cv::Mat left;
  cv::Mat right;
  Camera camera{};  ///< Of both: a pinhole of the model's focal length.
  double baseline_m = 0.0;
};

/// Images of the scene's camera and a second one `baseline_m` along its x (RenderImage), without
/// distortion, as the makers of such cameras deliver them. Errors: those of RenderImage;
/// kInvalidInput for a baseline that is not positive.
Expected<StereoImages> RenderStereo(const Scene& scene, int camera_index, double baseline_m,
                                    const ImageOptions& image);

/// Depth where both images match: OpenCV's semi-global matching (Hirschmueller 2008) with
/// left-right check and speckle filter, triangulated. Points [m] in the left camera's frame, row by
/// row, with grey levels as intensity. Only textured surfaces are found: see SceneWall::speckled.
/// Errors: kInvalidInput for options that are not positive.
Expected<PointCloud> MatchStereo(const StereoImages& images, const StereoOptions& options);

/// Where a point of both images is, in the left camera's frame; none without disparity.
std::optional<Eigen::Vector3d> Triangulate(const StereoImages& images, const Eigen::Vector2d& left,
                                           const Eigen::Vector2d& right);

}  // namespace sextant
