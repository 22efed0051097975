// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/diagnostics/repeated_pairs.h"
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
  /// By which every board is turned about its normal, as the LiDAR sees it; 0 for other orders.
  int turned_deg = 0;
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
  /// Orders that turn the boards and fit about as well as the given one, with other poses: nothing
  /// in the pairs says from which corner on the boards are listed.
  std::vector<OrderFinding> turned{};
  /// Why the pose of the given order is less likely than that of `better`, one of `turned`, which
  /// does not fit far better; empty for other orders.
  std::string unlikely_as_given{};
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
/// An order is better if its RMSE is less than half that of the given one, by more than chance (an
/// F-test at 0.5 %), and less than a fifth of the distance between neighbours, and the sensors do
/// not face each other. Two orders with different poses fit about equally well if the RMSE of one
/// is less than 1.5 times that of the other, or if a likelihood-ratio test at 1 % with unknown
/// noise does not separate them.
///
/// Where all boards are at one place, orders that turn them (turned_boards.h) are examined however
/// well the given one fits. One is better, or several are rivals, if the given order's RMSE is
/// above a fiftieth of the distance between neighbours and is that much larger by chance with a
/// probability below 0.5 %; or if it fits about as well and has an upright camera (y within 30 deg
/// of the LiDAR's -z) nearer to the LiDAR, where the given order has it upside down, or on its side
/// and far away.
OrderDiagnosis DiagnoseOrder(const CalibrationProblem& problem);

/// The problem with its LiDAR points reordered as the finding says. O(n log n).
CalibrationProblem Reordered(const CalibrationProblem& problem, const OrderFinding& order);

/// The pairs of the order whose LiDAR points are exchanged for each other, as by a slip in a list:
/// all that change do so two by two, they are at most a quarter of all, and no board has more than
/// two. Empty for other orders. Indices, the lower one first.
std::vector<std::array<int, 2>> ExchangedPairs(const OrderFinding& order);

/// The finding as one line, if there is any, with pairs by their place in the file, from which
/// `repeated` ones have been removed.
std::vector<std::string> Describe(const OrderDiagnosis& order,
                                  std::span<const RepeatedPairs> repeated = {});

/// The same, and what prevents a better order where there is none: the answer to a user who asked
/// for one.
std::string DescribeReordering(const OrderDiagnosis& order);

}  // namespace sextant
