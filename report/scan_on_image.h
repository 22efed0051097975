// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"

namespace sextant::cli {

struct ScanStyle {
  double point_px = 0.0;     ///< Diameter of a return; 0: by the image's size.
  bool all_returns = false;  ///< Also those that something nearer hides.
};

/// What was drawn.
struct ScanOnImage {
  int returns = 0;  ///< Of the scan.
  int in_view = 0;  ///< Within the image, hidden ones too.
  int hidden = 0;
  double nearest_m = 0.0;  ///< The colours' ends: 2 and 98 percent of the ranges in view.
  double farthest_m = 0.0;
};

/// Draws the returns onto the image, which is made paler, coloured by range from blue to red, the
/// farthest first, with a scale.
ScanOnImage DrawScanOnImage(const PointCloud& scan, const Camera& camera,
                            const Rigid3d& cam_from_lidar, const ScanStyle& style, cv::Mat& canvas);

/// A closed outline of straight edges in the camera frame, bent as the lens bends it.
void DrawOutline(const std::vector<Eigen::Vector3d>& corners_in_cam, const Camera& camera,
                 const cv::Scalar& colour, cv::Mat& canvas);

/// Words with a dark rim, to be read on any image.
void DrawLabel(const std::string& text, const cv::Point& at, double height_px,
               const cv::Scalar& colour, cv::Mat& canvas);

}  // namespace sextant::cli
