// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"

namespace sextant {

struct ScanStyle {
  double point_px = 0.0;     ///< Diameter of a return; 0: by the image's size.
  bool all_returns = false;  ///< Also those that are hidden by something nearer.
};

/// What was drawn.
struct ScanOnImage {
  int returns = 0;  ///< Number in the scan.
  int in_view = 0;  ///< Number in the image, including hidden ones.
  int hidden = 0;
  double nearest_m =
      0.0;  ///< Ends of the colour scale: 2nd and 98th percentile of the drawn ranges.
  double farthest_m = 0.0;
};

/// Makes the image paler and draws the returns on it, coloured by range from blue (near) to red
/// (far), with a scale.
ScanOnImage DrawScanOnImage(const PointCloud& scan, const Camera& camera,
                            const Rigid3d& cam_from_lidar, const ScanStyle& style, cv::Mat& canvas);

/// Draws the outline of a board from its corners in the camera frame, with the distortion of the
/// lens.
void DrawOutline(const std::vector<Eigen::Vector3d>& corners_in_cam, const Camera& camera,
                 const cv::Scalar& colour, cv::Mat& canvas);

/// Draws text with a dark rim, which is legible on any image.
void DrawLabel(const std::string& text, const cv::Point& at, double height_px,
               const cv::Scalar& colour, cv::Mat& canvas);

}  // namespace sextant
