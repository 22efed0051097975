// SPDX-License-Identifier: Apache-2.0
#include "report/quadrant_front.h"

#include <algorithm>
#include <cstddef>
#include <iterator>

namespace sextant {
namespace {

constexpr std::size_t FrontIndex(bool x_above, bool y_above) {
  return (x_above ? 1U : 0U) + (y_above ? 2U : 0U);
}

bool IsBeyond(double value, double limit, bool strict) {
  return strict ? value > limit : value >= limit;
}

}  // namespace

void QuadrantFront::Add(const Eigen::Vector2d& point) {
  for (const bool x_above : {false, true}) {
    for (const bool y_above : {false, true}) {
      Front& front = fronts_[FrontIndex(x_above, y_above)];
      const double x = x_above ? point.x() : -point.x();
      const double y = y_above ? point.y() : -point.y();
      auto next = std::ranges::lower_bound(front, x, {}, &Front::value_type::first);
      if (next != front.end() && next->second >= y) continue;
      // With an equal x, the point here dominates it.
      if (next != front.end() && next->first == x) ++next;
      auto first = next;
      while (first != front.begin() && std::prev(first)->second <= y) --first;
      if (first == next) {
        front.emplace(first, x, y);
      } else {
        *first = {x, y};
        front.erase(first + 1, next);
      }
    }
  }
}

bool QuadrantFront::HasWithin(const CoordinateBound& x, const CoordinateBound& y) const {
  const Front& front = fronts_[FrontIndex(x.above, y.above)];
  const double limit_x = x.above ? x.limit : -x.limit;
  const double limit_y = y.above ? y.limit : -y.limit;
  const auto first = std::ranges::partition_point(front, [&](const Front::value_type& point) {
    return !IsBeyond(point.first, limit_x, x.strict);
  });
  return first != front.end() && IsBeyond(first->second, limit_y, y.strict);
}

}  // namespace sextant
