// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/random.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// Errors of corners as extractors or people find them.
///
/// Defaults: four independent 3D edge lines at a range sigma of 1 cm leave 11.8 mm RMSE in the
/// LiDAR, so 6.8 mm per axis; a tag's depth is far less certain than its bearing; a corner that is
/// found in the image is good to 1 px, one that a person marks to 3 or 4 px.
struct CornerNoise {
  double lidar_sigma_m = 0.0068;  ///< Per axis.
  double camera_lateral_sigma_m = 0.003;
  double camera_depth_sigma_m = 0.010;
  double pixel_sigma_px = 1.0;
};

/// Appends a 3D-3D and a 2D-3D pair of one corner as they would be measured, with their covariance.
/// The projection into problem.camera must exist. Draws nine normal numbers.
void AddMeasuredCorner(const CornerNoise& noise, const PairId& id, const Eigen::Vector3d& in_cam,
                       const Eigen::Vector3d& in_lidar, const Eigen::Vector2d& pixel,
                       Random& random, CalibrationProblem& problem);

}  // namespace sextant
