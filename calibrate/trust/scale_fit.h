// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/calibration_problem.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// Relative excess of the camera's distances over the LiDAR's.
struct ScaleFit {
  double excess = 0.0;
  double sigma = 0.0;        ///< One standard deviation: the larger of residuals and jackknife.
  double sum_squares = 0.0;  ///< Remaining differences, whitened by their noise.
  /// How far the excess moves the pose (dphi, dt) of a solver that does not know of it.
  Vector6d shift = Vector6d::Zero();

  /// At least three sigmas and 0.6 percent: more than ranges and corners vary in good data.
  bool IsSignificant() const;
};

/// Two models of boards that appear too far away in images: a print smaller than the board file
/// states scales the whole distance, a focal length that is too long scales the depth only. Each is
/// a least-squares fit of pose and excess to the corners' differences.
/// The jackknife leaves out one board in one place at a time; views of a board that did not move
/// count as one.
/// None for fewer than two boards, and where their positions do not determine the excess.
struct ScaleFits {
  ScaleFit print{};
  ScaleFit focal{};

  bool IsPrint() const { return print.sum_squares <= focal.sum_squares; }
  const ScaleFit& Better() const { return IsPrint() ? print : focal; }
};
std::optional<ScaleFits> FitScales(const CalibrationProblem& problem,
                                   const Rigid3d& cam_from_lidar);

/// The covariance with the shift of a significant excess added as one standard deviation: whether
/// the camera or the LiDAR is right about the ranges is not known.
Matrix6d WithRangeDisagreement(const Matrix6d& covariance, const CalibrationProblem& problem,
                               const Rigid3d& cam_from_lidar);

}  // namespace sextant
