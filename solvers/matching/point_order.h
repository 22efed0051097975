// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solvers/matching/correspondence_model.h"

namespace sextant {

inline constexpr int kMaxOrderedPoints = 12;
inline constexpr int kMaxExchangedGroups = 16;

/// Pairs of one object, such as a board, whose LiDAR points may be listed in another order than the
/// camera's: 3 to kMaxOrderedPoints indices.
using PointGroup = std::vector<int>;

/// The groups of one view. Where there are at most kMaxExchangedGroups, groups of equal size may
/// have been exchanged for each other, too.
struct OrderView {
  std::vector<PointGroup> groups;
};

/// An order of the LiDAR points, and the pose under which it fits.
struct PointOrder {
  std::vector<int> lidar_index;  ///< For each pair the one whose LiDAR point belongs to it.
  Rigid3d cam_from_lidar;
  double rmse = 0.0;  ///< Over all pairs [m or px].
};

/// Distinct orders of the points within their groups, by ascending RMSE; at most 24. Pairs in no
/// group keep their LiDAR point.
///
/// Three camera points of a group that span a large triangle, with every three LiDAR points that
/// may be theirs, give start poses, up to 6000 from an evenly spread subset of the groups. They are
/// ranked by the distances to nearest points in up to 16 groups. From the best of them, the best
/// one-to-one assignment in each group and the pose by least squares are found in turns until the
/// assignment does not change. An order that fits well is missed only where the triangle's own
/// error misleads both of the two triangles that are tried.
///
/// Cost: a bounded number of starts, then O(pairs) time and memory. About 10 ms for 12 3D-3D pairs,
/// 30 ms for 12 pixels, 0.2 s for 10^4 pairs.
std::vector<PointOrder> FindPointOrders(const CorrespondenceModel& model,
                                        std::span<const OrderView> views);

/// The given order under its best pose. None where no pose exists.
std::optional<PointOrder> FitGivenOrder(const CorrespondenceModel& model);

}  // namespace sextant
