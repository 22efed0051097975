// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// A session simulated at the level of raw observations of a board, without images and scans.
///
/// Defaults: a 50 cm board with one tag of 20.5 cm at 1.8 to 2.5 m, one corner up, tilted about a
/// random axis by up to 45 degrees, in view of both sensors; a LiDAR with 16 rings 2 degrees apart.
struct ViewSimulation {
  std::uint64_t seed = 1;
  int views = 4;  ///< The board gets a new random pose in every view.
  double board_side_m = 0.5;
  double tag_edge_m = 0.205;
  double nearest_m = 1.8;
  double farthest_m = 2.5;
  int rings = 16;
  double ring_step_deg = 2.0;  ///< The rings are centred on the horizon.
  double azimuth_step_deg = 0.2;
  double range_sigma_m = 0.01;
  /// Error of an edge point across the board's side; uniformly distributed, like the error of a
  /// ring that is sampled in steps.
  double edge_sigma_m = 0.002;
  double pixel_sigma_px = 0.3;
  /// Drawn once a session, the view shift once a view, and stated in the problem. Growth is along
  /// and across the scan direction.
  LidarErrorModel errors = kWhiteNoiseOnly;
  /// Distance before the axis at which the beams cross; the returns are written as if they started
  /// at the origin (solvers/joint/beam_crossing.h). 0.042 in a VLP-16.
  double beam_crossing_m = 0.0;
  /// If true, the observations have no errors, but the same sigmas are stated.
  bool exact = false;
};

struct SimulatedViews {
  CalibrationProblem problem;
  Rigid3d true_cam_from_lidar;
  std::vector<Rigid3d> true_cam_from_board;  ///< One pose for each of problem.board_views.
};

/// Simulates board views and, from the same data, the corners that an optimal two-stage extractor
/// would give (pairs_3d3d with covariances), the same corners as pixels with LiDAR points
/// (pairs_2d3d: the board's corners projected with its pose estimated from the image), point sets,
/// board, camera and the true poses. The same seed gives the same bytes. Errors: kInvalidOption (no
/// views, noise or sizes that are not positive, a board that is never in view of both sensors).
Expected<SimulatedViews> SimulateViews(const ViewSimulation& simulation);

}  // namespace sextant
