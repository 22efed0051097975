// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// A session at the level of raw observations of a board, without images and scans.
///
/// Defaults: a 50 cm board with one tag of 20.5 cm at 1.8 to 2.5 m, hung from a corner, tilted any
/// way by up to 45 degrees, in view of both sensors; a LiDAR of 16 rings 2 degrees apart.
struct ViewSimulation {
  std::uint64_t seed = 1;
  int views = 4;  ///< The board is held anew for each.
  double board_side_m = 0.5;
  double tag_edge_m = 0.205;
  double nearest_m = 1.8;
  double farthest_m = 2.5;
  int rings = 16;
  double ring_step_deg = 2.0;  ///< The rings are spread about the horizon.
  double azimuth_step_deg = 0.2;
  double range_sigma_m = 0.01;
  /// Across the side; the error is uniform, as of a ring that is sampled in steps.
  double edge_sigma_m = 0.002;
  double pixel_sigma_px = 0.3;
  bool exact = false;  ///< Measured without error; the sigmas are stated all the same.
};

struct SimulatedViews {
  CalibrationProblem problem;
  Rigid3d true_cam_from_lidar;
  std::vector<Rigid3d> true_cam_from_board;  ///< Of each of problem.board_views.
};

/// Board views; of the same data, board corners as two-stage extractors make them of it at best
/// (pairs_3d3d, with their covariances) and corners as pixels with LiDAR points (pairs_2d3d, the
/// printed board's corners projected by its pose in the image); point sets, board, camera and the
/// truth. The same seed gives the same bytes. Errors: kInvalidOption (no views, negative noise, a
/// board that is never in view of both).
Expected<SimulatedViews> SimulateViews(const ViewSimulation& simulation);

}  // namespace sextant
