// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/scan_marks.h"

namespace sextant::cli {

/// A return where the scan, projected, shows it.
struct ProjectedReturn {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double range_m = 0.0;     ///< From the LiDAR.
  double distance_m = 0.0;  ///< From the camera.
  int ring = -1;            ///< -1 where the scan does not tell it.
};

/// The returns in front of the camera and within one picture's size of it, the farthest first, so
/// that nearer ones are drawn over them.
std::vector<ProjectedReturn> ProjectScan(const PointCloud& scan, const Camera& camera,
                                         const Rigid3d& cam_from_lidar);

/// What a quadrilateral holds.
struct ReturnCount {
  int returns = 0;
  int rings = 0;  ///< 0 where the scan does not tell them.
};
ReturnCount CountReturns(const std::vector<ProjectedReturn>& returns,
                         const Quadrilateral& quadrilateral);

}  // namespace sextant::cli
