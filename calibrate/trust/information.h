// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "geometry/calibration_problem.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// The least certain directions of rotation and of translation: eigenvectors of the largest
/// eigenvalues of the two 3x3 blocks of a covariance.
struct WeakestDirections {
  Eigen::Vector3d translation_axis_in_cam = Eigen::Vector3d::UnitX();  ///< Unit.
  double translation_sigma_m = 0.0;
  Eigen::Vector3d rotation_axis_in_cam = Eigen::Vector3d::UnitX();  ///< Unit.
  double rotation_sigma_rad = 0.0;
};
WeakestDirections WeakestOf(const Matrix6d& covariance);

/// "right-left", "down-up" or "forward" for an axis within 25 degrees of one of the camera's, else
/// its three numbers.
std::string AxisName(const Eigen::Vector3d& axis_in_cam);

/// "translation right-left 8.2 mm, rotation about forward 0.12 deg".
std::string DescribeWeakest(const WeakestDirections& weakest);

/// The inverse of an information matrix; none where a direction is not determined.
std::optional<Matrix6d> CovarianceOf(const Matrix6d& information);

/// Sets the information matrix of each kept view of the result, from the problem's board views
/// (solvers/joint/board_view_information.h), and the predicted sigma with all views up to it. Where
/// the result has a covariance, each I becomes T I T with the symmetric T for which they sum up to
/// its inverse, so that all figures are those of one covariance. Views without board views, and
/// views that the pose does not fit at all, get none.
void AddInformation(const CalibrationProblem& problem, CalibrationResult& result);

}  // namespace sextant
