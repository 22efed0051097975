// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/cloud_builder.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "base/median.h"
#include "geometry/coordinate_range.h"
#include "io/clouds/scalar_type.h"

namespace sextant {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMaxScan_s = 1000.0;

struct Ring {
  std::uint16_t id = 0;
  double elevation_rad = 0.0;
};

// The rings that have returns, by ascending id, with their mean elevation.
std::vector<Ring> RingsWithReturns(const PointCloud& cloud) {
  struct Sum {
    double elevation = 0.0;
    int count = 0;
  };
  std::map<std::uint16_t, Sum> sums;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const Eigen::Vector3d& p = cloud.points[i];
    if (!p.allFinite() || p.isZero()) continue;
    Sum& sum = sums[cloud.ring[i]];
    sum.elevation += std::atan2(p.z(), std::hypot(p.x(), p.y()));
    ++sum.count;
  }
  std::vector<Ring> rings;
  for (const auto& [id, sum] : sums) rings.push_back({id, sum.elevation / sum.count});
  return rings;
}

// The unit of times since 1970, by their size: Livox's driver has nanoseconds as floating point.
double UnitOf(double time_since_1970) {
  if (time_since_1970 > 1e17) return 1e-9;
  if (time_since_1970 > 1e14) return 1e-6;
  return time_since_1970 > 1e11 ? 1e-3 : 1.0;
}

// Rays without a return may lack a time, too: their times are NaN before and 0 after.
void MakeTimesRelative(std::vector<double>& times) {
  double first = std::numeric_limits<double>::infinity();
  double last = -first;
  for (const double time : times) {
    if (!std::isfinite(time)) continue;
    first = std::min(first, time);
    last = std::max(last, time);
  }
  const double start = first < 0.0 || last > kMaxScan_s ? first : 0.0;
  const double unit_s = UnitOf(last);
  for (double& time : times) time = std::isfinite(time) ? (time - start) * unit_s : 0.0;
}

}  // namespace

CloudBuilder::CloudBuilder(const CloudColumns& columns, std::size_t points) : columns_(columns) {
  cloud_.points.reserve(points);
  if (columns.intensity != CloudColumns::kNone) cloud_.intensity.reserve(points);
  if (columns.ring != CloudColumns::kNone) cloud_.ring.reserve(points);
  if (columns.time != CloudColumns::kNone) cloud_.time_s.reserve(points);
}

Expected<void> CloudBuilder::Add(const Value& value) {
  Eigen::Vector3d point;
  point.x() = value(columns_.x);
  point.y() = value(columns_.y);
  point.z() = value(columns_.z);
  const bool is_return = (point.array().abs() <= kMaxCoordinate_m).all();  // False for NaN.
  if (!is_return) point.setConstant(kNaN);
  double ring = 0.0;
  double time = 0.0;
  if (columns_.ring != CloudColumns::kNone) {
    ring = value(columns_.ring);
    const bool fits = IsRingNumber(ring);
    if (!fits && is_return) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("ring: expected a whole number from 0 to 65535, got {}", ring));
    }
    if (!fits) ring = 0.0;
  }
  if (columns_.time != CloudColumns::kNone) {
    time = value(columns_.time) * columns_.time_unit_s;
    if (!std::isfinite(time) && is_return) {
      return MakeError(ErrorCode::kNonFinite, "time: expected a finite number");
    }
  }
  cloud_.points.push_back(point);
  if (columns_.ring != CloudColumns::kNone) cloud_.ring.push_back(static_cast<std::uint16_t>(ring));
  if (columns_.time != CloudColumns::kNone) cloud_.time_s.push_back(time);
  if (columns_.intensity != CloudColumns::kNone) {
    cloud_.intensity.push_back(ToFloat(value(columns_.intensity)));
  }
  return {};
}

PointCloud CloudBuilder::Take() && {
  MakeTimesRelative(cloud_.time_s);
  return std::move(cloud_);
}

PointCloud CloudBuilder::Finish() && {
  if (!cloud_.ring.empty()) OrderRings(cloud_);
  return std::move(*this).Take();
}

Expected<void> CheckMetres(const PointCloud& cloud) {
  constexpr double kFarthest_m = 600.0;
  std::vector<double> ranges_m;
  for (const Eigen::Vector3d& point : cloud.points) {
    if (point.allFinite() && !point.isZero()) ranges_m.push_back(point.norm());
  }
  if (ranges_m.empty()) return {};
  const double median_m = UpperMedian(ranges_m);
  if (median_m <= kFarthest_m) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("half of the points are {:.0f} m away and more; coordinates are in "
                               "metres and begin at the sensor. If these are millimetres, divide "
                               "by 1000",
                               median_m));
}

void OrderRings(PointCloud& cloud) {
  std::vector<Ring> rings = RingsWithReturns(cloud);
  if (rings.size() < 2) return;
  std::size_t rising = 0;
  for (std::size_t i = 1; i < rings.size(); ++i) {
    rising += rings[i].elevation_rad > rings[i - 1].elevation_rad ? 1U : 0U;
  }
  // On a small surface, noise swaps neighbouring rings of a dense sensor; an order of firing swaps
  // half of all neighbours.
  const std::size_t steps = rings.size() - 1;
  if (4 * rising >= 3 * steps) return;
  const std::uint16_t highest = *std::max_element(cloud.ring.begin(), cloud.ring.end());
  if (4 * rising <= steps) {
    for (std::uint16_t& ring : cloud.ring) ring = static_cast<std::uint16_t>(highest - ring);
    return;
  }
  std::sort(rings.begin(), rings.end(),
            [](const Ring& a, const Ring& b) { return a.elevation_rad < b.elevation_rad; });
  // Rings without a return get numbers above the others.
  std::map<std::uint16_t, std::uint16_t> place;
  for (const Ring& ring : rings) place.emplace(ring.id, static_cast<std::uint16_t>(place.size()));
  for (std::uint16_t& ring : cloud.ring) {
    ring = place.emplace(ring, static_cast<std::uint16_t>(place.size())).first->second;
  }
}

}  // namespace sextant
