// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Another order of the LiDAR's corners that fits far better than the given one.
struct OrderFinding {
  double rmse_as_given_m = 0.0;
  double rmse_reordered_m = 0.0;
  /// lidar_index[i]: which pair's LiDAR point belongs to the camera point of pair i.
  std::vector<int> lidar_index;
  bool boards_swapped = false;
  std::vector<PairId> moved;  ///< Pairs whose LiDAR point changes.
};

/// A board whose edges differ between the sensors, or from its known size, by more than noise.
struct EdgeFinding {
  int view = 0;
  int board = 0;
  int edge = 0;  ///< From corner `edge` to the next; the one that differs most.
  double in_cam_m = 0.0;
  double in_lidar_m = 0.0;
  std::optional<double> known_m;
};

/// A direction of the pose that the geometry leaves far weaker than the best one.
struct WeakDirection {
  bool is_rotation = false;
  Eigen::Vector3d axis_in_cam = Eigen::Vector3d::Zero();  ///< Unit.
  double sigma = 0.0;                                     ///< One standard deviation, rad or m.
  double best_sigma = 0.0;  ///< Of the strongest direction of the same kind.
};

/// What the pairs say about themselves before anyone believes the pose.
struct PairDiagnostics {
  std::optional<OrderFinding> order;
  std::vector<EdgeFinding> edges;
  std::optional<WeakDirection> weak_rotation;
  std::optional<WeakDirection> weak_translation;
  /// RMSE of the best reflection, set where it is less than half that of the best rotation.
  std::optional<double> mirrored_rmse_m;
};

/// Judges 3D-3D pairs; empty for problems without.
///
/// Order: one board's camera corners against any board's LiDAR corners in any of the eight orders
/// of a rectangle give a pose; all boards of each view are assigned under it and the pose is fitted
/// again until nothing moves; the best of all starts is reported where its RMSE is less than half
/// of the given order's, the latter over a tenth and the former under a fifth of the mean edge.
/// Needs boards of four corners. Edges are compared in the better order; they are reported beyond 5
/// percent of their length and three standard deviations of their difference, where the noise is
/// stated. Weak: one standard deviation over five times that of the strongest direction.
PairDiagnostics DiagnosePairs(const CalibrationProblem& problem);

/// The problem with its LiDAR points moved to the pairs that the finding says.
CalibrationProblem Reordered(const CalibrationProblem& problem, const OrderFinding& order);

/// The findings in words, a line each, with both figures and what to do.
std::vector<std::string> Describe(const PairDiagnostics& judgement);

}  // namespace sextant
