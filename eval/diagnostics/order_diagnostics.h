// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// An order of the LiDAR points other than the given one.
struct OrderFinding {
  bool in_pixels = false;  ///< Whether it is one of the 2D-3D pairs.
  double rmse = 0.0;       ///< [m or px]
  Rigid3d cam_from_lidar{};
  /// lidar_index[i]: the pair whose LiDAR point belongs to the camera point of pair i.
  std::vector<int> lidar_index{};
  bool boards_swapped = false;
  std::vector<PairId> moved{};  ///< Pairs whose LiDAR point changes with the new order.
};

/// Whether the LiDAR points are in the order of the camera's.
struct OrderDiagnosis {
  bool in_pixels = false;
  std::optional<double> rmse_as_given{};  ///< Best over all poses [m or px]; none without a pose.
  /// Under that pose the sensors are on opposite sides of the boards, facing each other.
  bool faces_as_given = false;
  std::optional<OrderFinding> better{};  ///< The one order that fits far better than the given one.
  /// Several orders that fit far better, and about equally well among themselves, by ascending
  /// RMSE: the data does not determine the order.
  std::vector<OrderFinding> rivals{};
  std::string not_searched{};  ///< Why other orders were not examined; empty if they were.
};

/// Looks for a better order of the LiDAR points of the 3D-3D pairs, or of the 2D-3D pairs where
/// there are no others, if the given order fits badly (RMSE above a tenth of the mean distance
/// between neighbouring points) or has the sensors face each other.
///
/// The points of each board in a view may be in any order, and boards of a view may be exchanged
/// for each other; or else all points of a view, where the pairs state no boards or these do not
/// explain the data. Boards and views of more than 12 points are not examined, and above 16 boards
/// in a view their exchange is not (solvers/matching/point_order.h, which states the cost).
///
/// An order is better if its RMSE is less than half that of the given one and less than a fifth of
/// the distance between neighbours, and the sensors do not face each other. Two orders with
/// different poses fit about equally well if the RMSE of one is less than 1.5 times that of the
/// other, or if a likelihood-ratio test at 1 % with unknown noise does not separate them.
OrderDiagnosis DiagnoseOrder(const CalibrationProblem& problem);

/// The problem with its LiDAR points reordered as the finding says. O(n log n).
CalibrationProblem Reordered(const CalibrationProblem& problem, const OrderFinding& order);

/// The finding as one line, if there is any.
std::vector<std::string> Describe(const OrderDiagnosis& order);

/// The same, and what prevents a better order where there is none: the answer to a user who asked
/// for one.
std::string DescribeReordering(const OrderDiagnosis& order);

}  // namespace sextant
