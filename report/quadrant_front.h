// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <utility>
#include <vector>

namespace sextant {

/// A half line of a coordinate: above a limit or below it; `strict` excludes the limit.
struct CoordinateBound {
  bool above = true;
  double limit = 0.0;
  bool strict = false;
};

/// A growing set of points that answers whether one of them lies in a quadrant of the plane,
/// whichever way it opens. For each of the four directions it keeps the points that no other
/// dominates (the Pareto front), sorted, so that an answer takes O(log n) and the fronts of points
/// that scatter stay short: about log n.
class QuadrantFront {
 public:
  void Add(const Eigen::Vector2d& point);
  bool HasWithin(const CoordinateBound& x, const CoordinateBound& y) const;

 private:
  /// Coordinates with the sign by which greater ones lie farther in; ascending x, descending y.
  using Front = std::vector<std::pair<double, double>>;
  std::array<Front, 4> fronts_;
};

}  // namespace sextant
