// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/random.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// Errors of corners found by extractors or marked by people.
///
/// Defaults: intersecting four independent 3D edge lines at a range sigma of 1 cm leaves 11.8 mm
/// RMSE in the LiDAR, that is 6.8 mm per axis; a tag's depth is far less certain than its bearing;
/// a corner detected in the image is accurate to 1 px, one marked by a person to 3 or 4 px.
struct CornerNoise {
  double lidar_sigma_m = 0.0068;  ///< Per axis.
  double camera_lateral_sigma_m = 0.003;
  double camera_depth_sigma_m = 0.010;
  double pixel_sigma_px = 1.0;
};

/// Appends the measured 3D-3D and 2D-3D pair of one corner, with noise and its covariance. The
/// projection into problem.camera must exist. Draws nine normal numbers.
void AddMeasuredCorner(const CornerNoise& noise, const PairId& id, const Eigen::Vector3d& in_cam,
                       const Eigen::Vector3d& in_lidar, const Eigen::Vector2d& pixel,
                       Random& random, CalibrationProblem& problem);

}  // namespace sextant
