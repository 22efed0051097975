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

// The range at which a ray leaves the cylinder of a round hole, where it is inside of it at
// `range`.
std::optional<double> LeaveHole(const LidarRay& ray, const RoundHole& hole, double range) {
  const Eigen::Vector2d from =
      (ray.origin + range * ray.direction).head<2>() - hole.center_in_board_m;
  const Eigen::Vector2d along = ray.direction.head<2>();
  const double inside = hole.radius_m * hole.radius_m - from.squaredNorm();
  if (inside <= 0.0) return std::nullopt;
  const double a = along.squaredNorm();
  if (a == 0.0) return std::numeric_limits<double>::infinity();
  const double b = from.dot(along);
  return range + (std::sqrt(b * b + a * inside) - b) / a;
}

// Where a ray that meets the front at `span` ends in a round hole: passed, or met its wall. None if
// it meets no hole.
struct HolePassage {
  std::optional<LidarEntry> entry{};
};

std::optional<HolePassage> PassHoles(const LidarRay& ray, const std::vector<RoundHole>& holes,
                                     const Span& span) {
  if (span.axis != 2) return std::nullopt;
  for (const RoundHole& hole : holes) {
    const std::optional<double> leave = LeaveHole(ray, hole, span.first);
    if (!leave) continue;
    if (*leave >= span.last) return HolePassage{};
    const Eigen::Vector2d wall =
        ((ray.origin + *leave * ray.direction).head<2>() - hole.center_in_board_m).cwiseAbs();
    return HolePassage{LidarEntry{.range_m = *leave, .face = wall.x() > wall.y() ? 0 : 1}};
  }
  return std::nullopt;
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
  if (const auto passage = PassHoles(ray, round_holes, span)) return passage->entry;
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
  for (const RoundHole& hole : round_holes) {
    const double from = (point.head<2>() - hole.center_in_board_m).norm();
    if (entry.face != 2 || from < hole.radius_m + reach) return false;
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
