// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/scan_marks.h"

namespace sextant {

/// A return of a scan with its position in the picture.
struct ProjectedReturn {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double range_m = 0.0;     ///< Distance from the LiDAR.
  double distance_m = 0.0;  ///< Distance from the camera.
  int ring = -1;            ///< -1 if the scan has no rings.
  int index = 0;            ///< Index into the scan.
};

/// The returns in front of the camera and in the picture or a margin of its size around it; sorted
/// from far to near, so that nearer ones are drawn over farther ones.
std::vector<ProjectedReturn> ProjectScan(const PointCloud& scan, const Camera& camera,
                                         const Rigid3d& cam_from_lidar);

/// The returns inside a quadrilateral.
struct ReturnCount {
  int returns = 0;
  int rings = 0;  ///< 0 if the scan has no rings.
};
ReturnCount CountReturns(const std::vector<ProjectedReturn>& returns,
                         const Quadrilateral& quadrilateral);

}  // namespace sextant
