// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "geometry/calibration_problem.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// By how much the camera's distances are too long against the LiDAR's, as a share.
struct ScaleFit {
  double excess = 0.0;
  double sigma = 0.0;        ///< One standard deviation, from the residuals.
  double sum_squares = 0.0;  ///< Left of the boards' differences, whitened by their noise.
};

/// Two ways in which boards may seem too far away in images: all of the distance grows with a print
/// that is smaller than the board file says, only the depth with a focal length that is too long.
/// Least squares of the corners' differences over the pose and the share.
/// None for fewer than two boards, and where the boards' places leave it open.
struct ScaleFits {
  ScaleFit print{};
  ScaleFit focal{};
};
std::optional<ScaleFits> FitScales(const CalibrationProblem& problem,
                                   const Rigid3d& cam_from_lidar);

/// What contradicts the board file, the intrinsics or the session in the measurements, in words, a
/// line each, with figures and what to do: sizes of boards in the scans, distances that are too
/// long or short in the images, prints that the camera model does not fit, views that repeat each
/// other or are too few. Empty where nothing does.
std::vector<std::string> Diagnose(std::span<const SessionView> views, const Assembly& assembly,
                                  const Rigid3d& cam_from_lidar);

}  // namespace sextant
