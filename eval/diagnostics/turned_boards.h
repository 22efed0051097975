// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Another order of the LiDAR points: that of boards whose corners are counted from another one.
struct TurnedOrder {
  int angle_deg = 0;  ///< About each board's normal, counter-clockwise as the LiDAR sees it.
  std::vector<int> lidar_index{};  ///< For each pair the one whose LiDAR point belongs to it.
};

struct TurnedBoards {
  std::vector<std::vector<int>> groups{};  ///< The pairs of each board and view.
  std::vector<TurnedOrder> orders{};
};

/// The orders in which every board looks the same from another corner on. Boards are the groups of
/// three or more pairs with one board and view, or all pairs of the only view where no board has
/// so many. Their LiDAR points must be on planes. Angles are those of regular polygons; a board has
/// one if each turned point is nearer to another one than a third of the distance between
/// neighbours, and boards of four have all three quarter turns, because another pose may take up
/// what does not match. Empty where boards are at different places, which tell the orders apart,
/// and above 200 pairs on a board or 2000 in all. O(pairs times pairs of a board).
TurnedBoards TurnBoards(const std::vector<PairId>& ids, std::span<const Eigen::Vector3d> in_lidar);

}  // namespace sextant
