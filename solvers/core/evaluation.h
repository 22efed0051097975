// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// How well a pose explains a problem; the same definition for every solver.
struct Evaluation {
  /// sqrt(mean_i |point_in_cam_i - cam_from_lidar * point_in_lidar_i|^2), the paper's RMSE; none
  /// without 3D-3D pairs.
  std::optional<double> rmse_m;
  /// sqrt(mean_i |pixel_i - projection_i|^2) over the pairs in front of the camera; none without
  /// 2D-3D pairs and camera, or when no pair projects.
  std::optional<double> rmse_px;
  std::vector<double> per_pair_m;
  std::vector<double> per_pair_px;  ///< Infinite where the point does not project.
  /// 1/2 sum of squared residuals over all pairs, each divided by its sigma where it states one;
  /// pairs that do not project are left out.
  double cost = 0.0;
};

Evaluation Evaluate(const CalibrationProblem& problem, const Rigid3d& cam_from_lidar);

}  // namespace sextant
