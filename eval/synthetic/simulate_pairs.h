// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// A session at the level of corners: what the extractors would hand to the solvers.
///
/// Defaults: the paper's two boards (48.4 x 46.8 and 49.0 x 46.8 cm) hung from a corner about 2 m
/// away, a VLP-16 and a ZED-like camera. Noise of the LiDAR corners: four independent 3D edge lines
/// at a range sigma of 1 cm leave 11.8 mm RMSE, so 6.8 mm per axis; of the camera corners: a tag's
/// depth is far less certain than its bearing; marking in the image: 1 px.
struct PairSimulation {
  std::uint64_t seed = 1;
  int views = 1;                  ///< The boards are hung anew for every view.
  int outliers = 1;               ///< Corners of the whole session whose LiDAR point is displaced.
  double lidar_sigma_m = 0.0068;  ///< Per axis.
  double camera_lateral_sigma_m = 0.003;
  double camera_depth_sigma_m = 0.010;
  double pixel_sigma_px = 1.0;
  double outlier_shift_m = 0.25;
};

struct SimulatedSession {
  CalibrationProblem problem;
  Rigid3d true_cam_from_lidar;
};

/// Pairs of both kinds with their stated noise, point sets, boards, camera and the truth; the same
/// seed gives the same bytes. Errors: kInvalidOption (no views, negative noise, more outliers than
/// corners).
Expected<SimulatedSession> SimulatePairs(const PairSimulation& simulation);

}  // namespace sextant
