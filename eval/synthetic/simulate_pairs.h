// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// A session simulated at the level of corners, as extractors would pass them to the solvers.
///
/// Defaults: the paper's two boards (48.4 x 46.8 and 49.0 x 46.8 cm), one corner up, about 2 m
/// away, a VLP-16 and a ZED-like camera. Noise of the LiDAR corners: intersecting four independent
/// 3D edge lines at a range sigma of 1 cm leaves 11.8 mm RMSE, that is 6.8 mm per axis. Noise of
/// the camera corners: a tag's depth is far less certain than its bearing. Marking in the image: 1
/// px.
struct PairSimulation {
  static constexpr int kMaxViews = 20'000;

  std::uint64_t seed = 1;
  int views = 1;     ///< The boards get a new random pose in every view.
  int outliers = 1;  ///< Number of corners in the whole session whose LiDAR point is displaced.
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

/// Simulates pairs of both kinds with their stated noise, point sets, boards, camera and the true
/// pose. The same seed gives the same bytes. Errors: kInvalidOption (not 1 to kMaxViews views,
/// noise that is not positive, more outliers than corners).
Expected<SimulatedSession> SimulatePairs(const PairSimulation& simulation);

}  // namespace sextant
