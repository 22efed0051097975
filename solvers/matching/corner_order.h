// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The corners of one board as each sensor lists them, in cyclic order, but possibly from different
/// first corners and in opposite directions. Equally many, at least 3 [m].
struct CornerGroup {
  std::vector<Eigen::Vector3d> in_b;
  std::vector<Eigen::Vector3d> in_a;
};

/// One of the 2n cyclic orders of n corners.
struct CornerOrder {
  int first = 0;  ///< Corner of a that is corner 0 of b.
  bool reversed = false;

  /// Index in a of corner k of b.
  int IndexInA(int k, int corners) const {
    return (first + (reversed ? corners - k : k)) % corners;
  }
  friend bool operator==(const CornerOrder&, const CornerOrder&) = default;
};

struct CornerOrderFit {
  std::vector<CornerOrder> orders;  ///< One for each group.
  Rigid3d b_from_a;
  double rmse_m = 0.0;  ///< RMS over all corners.
};

/// The pose and the orders of all groups together that minimise the sum of squared distances.
///
/// As boards are symmetric, the corners of one board fit in several orders; the orders are
/// determined by one pose for all groups (solvers/matching/object_match.h, with each group as a
/// view and each order as a pairing). Starts: the fit of the groups' centroids, which do not depend
/// on the orders, and every order of the groups. With one group, or groups that share a symmetry,
/// the orders are not determined: those nearest to the listed order are returned. Errors:
/// kTooFewPairs (no group); kInvalidInput (uneven or short groups); kDegenerate.
Expected<CornerOrderFit> ResolveCornerOrders(std::span<const CornerGroup> groups);

}  // namespace sextant
