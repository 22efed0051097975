// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "simulator/lidar/lidar_shape.h"

namespace sextant {
namespace {

struct Chord {
  double side_first = 0.0;
  double side_last = 0.0;
  double ends_first = 0.0;
  double ends_last = 0.0;

  double First() const { return std::max(side_first, ends_first); }
  double Last() const { return std::min(side_last, ends_last); }
};

// The range intervals inside the infinite cylinder and between the planes of its ends; none if
// their intersection is empty.
std::optional<Chord> Cut(const LidarRay& ray, double radius_m, double low_m, double high_m) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Chord chord{-kInfinity, kInfinity, -kInfinity, kInfinity};
  const Eigen::Vector2d origin = ray.origin.head<2>();
  const Eigen::Vector2d direction = ray.direction.head<2>();
  const double a = direction.squaredNorm();
  if (a == 0.0) {
    if (origin.norm() > radius_m) return std::nullopt;
  } else {
    // The distance between axis and ray, projected along the axis, avoids a difference of large
    // squares.
    const double middle = -origin.dot(direction) / a;
    const double miss = (origin + middle * direction).norm();
    if (miss > radius_m) return std::nullopt;
    const double half = std::sqrt((radius_m - miss) * (radius_m + miss) / a);
    chord.side_first = middle - half;
    chord.side_last = middle + half;
  }
  const double dz = ray.direction.z();
  if (dz == 0.0) {
    if (ray.origin.z() < low_m || ray.origin.z() > high_m) return std::nullopt;
  } else {
    const double to_low = (low_m - ray.origin.z()) / dz;
    const double to_high = (high_m - ray.origin.z()) / dz;
    chord.ends_first = std::min(to_low, to_high);
    chord.ends_last = std::max(to_low, to_high);
  }
  if (chord.First() > chord.Last()) return std::nullopt;
  return chord;
}

}  // namespace

std::optional<LidarEntry> LidarCylinder::Enter(const LidarRay& ray) const {
  const std::optional<Chord> chord = Cut(ray, radius_m, 0.0, height_m);
  if (!chord || chord->First() <= 0.0) return std::nullopt;
  return LidarEntry{.range_m = chord->First(),
                    .face = chord->side_first >= chord->ends_first ? 0 : 2};
}

bool LidarCylinder::AllEnter(const LidarRay& ray, const LidarEntry& entry,
                             double spot_radius_m) const {
  const Eigen::Vector3d point = ray.origin + entry.range_m * ray.direction;
  if (entry.face == 2) {
    const double reach = spot_radius_m / std::abs(ray.direction.z());
    return point.head<2>().norm() + reach < radius_m;
  }
  // The outermost ray of the spot passes the axis spot_radius farther away and enters later; until
  // then it has moved along the axis by at most `reach`.
  const double level = ray.direction.head<2>().norm();
  const Eigen::Vector2d along = ray.direction.head<2>() / level;
  const double miss = std::abs(along.x() * point.y() - along.y() * point.x());
  if (miss + spot_radius_m >= radius_m) return false;
  const double deepest =
      std::sqrt(radius_m * radius_m - (miss + spot_radius_m) * (miss + spot_radius_m));
  const double nearest =
      std::sqrt(radius_m * radius_m - std::pow(std::max(0.0, miss - spot_radius_m), 2));
  const double reach = (spot_radius_m + (nearest - deepest) * std::abs(ray.direction.z())) / level;
  return point.z() > reach && point.z() < height_m - reach;
}

std::optional<double> LidarCylinder::MayEnter(const LidarRay& ray, double spot_radius_m) const {
  const std::optional<Chord> chord =
      Cut(ray, radius_m + spot_radius_m, -spot_radius_m, height_m + spot_radius_m);
  if (!chord || chord->Last() <= 0.0) return std::nullopt;
  return std::max(chord->First(), 0.0);
}

}  // namespace sextant
