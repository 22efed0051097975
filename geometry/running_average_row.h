// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace sextant {

/// One iteration in the log of the original package (avg_values.txt): its running average of
/// cam_from_lidar after `iteration` scans, as printed. The rotation is not a mean; see
/// solvers/averaging/rotation_average.h.
struct RunningAverageRow {
  int iteration = 0;  ///< Counts from 1.
  Eigen::Vector3d mean_translation_m = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  double rmse_m = 0.0;  ///< This iteration's scan under the running average.
};

}  // namespace sextant
