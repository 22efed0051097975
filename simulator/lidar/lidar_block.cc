// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "simulator/lidar/lidar_shape.h"

namespace sextant {
namespace {

// The range interval in which a ray is between bounds; empty if first > last.
struct Span {
  double first = -std::numeric_limits<double>::infinity();
  double last = std::numeric_limits<double>::infinity();
  int axis = 0;  // The axis whose bound determines `first`.

  bool Empty() const { return first > last; }

  void Clip(double origin, double direction, double low, double high, int clip_axis) {
    if (direction == 0.0) {
      if (origin < low || origin > high) {
        first = std::numeric_limits<double>::infinity();
        last = -first;
      }
      return;
    }
    double enter = (low - origin) / direction;
    double leave = (high - origin) / direction;
    if (enter > leave) std::swap(enter, leave);
    if (enter > first) {
      first = enter;
      axis = clip_axis;
    }
    last = std::min(last, leave);
  }
};

Span Within(const LidarRay& ray, const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Span span;
  // z first, as most blocks are thin along z and are entered there; of equal bounds the first one
  // counts.
  for (const int axis : {2, 0, 1}) {
    span.Clip(ray.origin[axis], ray.direction[axis], low[axis], high[axis], axis);
  }
  return span;
}

}  // namespace

std::optional<LidarEntry> LidarBlock::Enter(const LidarRay& ray) const {
  const Span span = Within(ray, low, high);
  if (span.Empty() || span.first <= 0.0) return std::nullopt;
  if (has_hole) {
    Span hole;
    for (const int axis : {0, 1}) {
      hole.Clip(ray.origin[axis], ray.direction[axis], hole_low[axis], hole_high[axis], axis);
    }
    if (!hole.Empty() && hole.first < span.first && span.first < hole.last) {
      // The ray enters the opening: it passes through or hits its inner side.
      if (hole.last >= span.last) return std::nullopt;
      const double x = ray.origin.x() + hole.last * ray.direction.x();
      const bool across_x = std::min(std::abs(x - hole_low.x()), std::abs(x - hole_high.x())) <
                            1e-9 * (1.0 + hole.last);
      return LidarEntry{.range_m = hole.last, .face = across_x ? 0 : 1};
    }
  }
  return LidarEntry{.range_m = span.first, .face = span.axis};
}

bool LidarBlock::AllEnter(const LidarRay& ray, const LidarEntry& entry, double radius_m) const {
  const Eigen::Vector3d point = ray.origin + entry.range_m * ray.direction;
  // A parallel ray at the offset w hits the face's plane at most |w| / cos(incidence) from here.
  const double reach = radius_m / std::abs(ray.direction[entry.face]);
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == entry.face) continue;
    if (point[axis] - low[axis] < reach || high[axis] - point[axis] < reach) return false;
  }
  if (!has_hole) return true;
  return entry.face == 2 &&
         (point.x() < hole_low.x() - reach || point.x() > hole_high.x() + reach ||
          point.y() < hole_low.y() - reach || point.y() > hole_high.y() + reach);
}

std::optional<double> LidarBlock::MayEnter(const LidarRay& ray, double radius_m) const {
  const Eigen::Vector3d around = Eigen::Vector3d::Constant(radius_m);
  const Span span = Within(ray, low - around, high + around);
  if (span.Empty() || span.last <= 0.0) return std::nullopt;
  return std::max(span.first, 0.0);
}

}  // namespace sextant
