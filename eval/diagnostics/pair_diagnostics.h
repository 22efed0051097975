// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// An order of the LiDAR corners that fits far better than the given one.
struct OrderFinding {
  double rmse_as_given_m = 0.0;
  double rmse_reordered_m = 0.0;
  /// lidar_index[i]: the pair whose LiDAR point belongs to the camera point of pair i.
  std::vector<int> lidar_index;
  bool boards_swapped = false;
  std::vector<PairId> moved;  ///< Pairs whose LiDAR point changes with the new order.
};

/// A board whose edges differ between the sensors, or from the nominal size, by more than noise
/// explains.
struct EdgeFinding {
  int view = 0;
  int board = 0;
  int edge = 0;  ///< The edge from corner `edge` to the next one; the one that differs most.
  double in_cam_m = 0.0;
  double in_lidar_m = 0.0;
  std::optional<double> known_m;
};

/// A direction of the pose that the geometry determines far less well than the best one.
struct WeakDirection {
  bool is_rotation = false;
  Eigen::Vector3d axis_in_cam = Eigen::Vector3d::Zero();  ///< Unit vector.
  double sigma = 0.0;                                     ///< One standard deviation, rad or m.
  /// Standard deviation of the best determined direction of the same kind.
  double best_sigma = 0.0;
};

/// Data diagnostics: properties of the pairs that make a pose from them unreliable.
struct PairDiagnostics {
  std::optional<OrderFinding> order;
  std::vector<EdgeFinding> edges;
  std::optional<WeakDirection> weak_rotation;
  std::optional<WeakDirection> weak_translation;
  /// RMSE of the best reflection, set only if it is less than half that of the best rotation.
  std::optional<double> mirrored_rmse_m;
};

/// Checks the 3D-3D pairs for wrong orders, wrong edges, mirrored data and weak directions; empty
/// for a problem with fewer than three pairs.
///
/// Order: matching one board's camera corners with any board's LiDAR corners, in each of the eight
/// orders of a rectangle, gives a start pose; all boards of each view are assigned under it and the
/// pose is refitted until the assignment is stable. The best result over all starts is reported if
/// its RMSE is less than half that of the given order, the latter is above a tenth and the former
/// below a fifth of the mean edge. Boards need all four corners. Edges: compared in the better
/// order, and reported if they differ by more than 5 percent of their length and by more than three
/// standard deviations of their difference (if the noise is stated). Weak direction: its standard
/// deviation is more than five times that of the best determined direction.
PairDiagnostics DiagnosePairs(const CalibrationProblem& problem);

/// The problem with its LiDAR points reordered as the finding says.
CalibrationProblem Reordered(const CalibrationProblem& problem, const OrderFinding& order);

/// One line of text per finding, with the figures and advice.
std::vector<std::string> Describe(const PairDiagnostics& diagnostics);

}  // namespace sextant
