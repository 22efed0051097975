// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/scan_rings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace sextant {
namespace {

constexpr double kNearest_m = 0.01;  // Sensors write zeros for what did not return.
constexpr int kMostRings = 256;

double Median(std::vector<double>& values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Rings by elevations that repeat: sorted, they fall into steps with empty gaps between them. Beams
// that leave beside the origin smear a ring's elevations, so that small gaps may part one ring: the
// smallest gap counts for which no two rings are far closer than is usual. Empty where elevations
// do not repeat, as with a rosette.
std::vector<int> RingsOfElevations(const std::vector<double>& elevations) {
  std::vector<std::size_t> order(elevations.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return elevations[i]; });
  for (const double gap_deg : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8}) {
    const double gap = gap_deg * std::numbers::pi / 180.0;
    std::vector<int> rings(elevations.size(), 0);
    std::vector<double> lows = {elevations[order[0]]};
    double widest = 0.0;
    for (std::size_t i = 1; i < order.size(); ++i) {
      const double elevation = elevations[order[i]];
      if (elevation - elevations[order[i - 1]] > gap) lows.push_back(elevation);
      widest = std::max(widest, elevation - lows.back());
      rings[order[i]] = static_cast<int>(lows.size()) - 1;
    }
    if (lows.size() < 4 || lows.size() > kMostRings) continue;
    std::vector<double> steps;
    for (std::size_t i = 1; i < lows.size(); ++i) steps.push_back(lows[i] - lows[i - 1]);
    const double least = *std::ranges::min_element(steps);
    const double usual = Median(steps);
    if (least > 0.25 * usual && widest < 0.5 * usual) return rings;
  }
  return {};
}

// Bands as high as the points are apart on average over the solid angle that they cover.
std::vector<int> BandsOfElevation(const std::vector<double>& elevations,
                                  const std::vector<double>& azimuths) {
  const auto [low, high] = std::ranges::minmax(elevations);
  const auto [left, right] = std::ranges::minmax(azimuths);
  const double area = std::max((high - low) * (right - left), 1e-12);
  const double band = std::max(1.5 * std::sqrt(area / static_cast<double>(elevations.size())),
                               (high - low) / kMostRings + 1e-9);
  std::vector<int> rings;
  rings.reserve(elevations.size());
  for (const double elevation : elevations) {
    rings.push_back(static_cast<int>((elevation - low) / band));
  }
  return rings;
}

std::vector<int> RecoverRings(const std::vector<RingPoint>& points) {
  std::vector<double> elevations;
  elevations.reserve(points.size());
  for (const RingPoint& point : points) {
    elevations.push_back(std::asin(point.point.z() / point.range_m));
  }
  std::vector<int> rings = RingsOfElevations(elevations);
  if (!rings.empty()) return rings;
  std::vector<double> azimuths;
  azimuths.reserve(points.size());
  for (const RingPoint& point : points) azimuths.push_back(point.azimuth_rad);
  return BandsOfElevation(elevations, azimuths);
}

// A flat surface's second difference of range is noise alone, of sqrt 6 sigma; the median leaves
// out where objects begin.
double RangeSigma(const ScanRings& scan) {
  constexpr double kSigmaOfMedian = 1.0 / 0.6745;
  std::vector<double> bends;
  bends.reserve(scan.points().size());
  for (int ring = 0; ring < scan.rings(); ++ring) {
    const std::span<const RingPoint> points = scan.ring(ring);
    for (std::size_t i = 2; i < points.size(); ++i) {
      bends.push_back(
          std::abs(points[i - 2].range_m - 2.0 * points[i - 1].range_m + points[i].range_m));
    }
  }
  return kSigmaOfMedian * Median(bends) / std::sqrt(6.0);
}

}  // namespace

Expected<ScanRings> ScanRings::Build(const PointCloud& cloud) {
  const std::size_t count = cloud.points.size();
  if (!cloud.ring.empty() && cloud.ring.size() != count) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("the scan has {} points but {} ring numbers", count, cloud.ring.size()));
  }
  std::vector<RingPoint> kept;
  std::vector<int> ring_of;
  kept.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d& point = cloud.points[i];
    const double range = point.norm();
    if (!std::isfinite(range) || range < kNearest_m) continue;
    kept.push_back({point, range, std::atan2(point.y(), point.x()), static_cast<int>(i)});
    if (!cloud.ring.empty()) ring_of.push_back(cloud.ring[i]);
  }
  if (kept.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("none of the scan's {} points is a finite return", count));
  }
  if (ring_of.empty()) ring_of = RecoverRings(kept);

  // Ring numbers may be sparse or count downwards: order them by their median elevation,
  // found among sines, which sort alike.
  const int highest = *std::ranges::max_element(ring_of);
  std::vector<std::vector<double>> of_ring(static_cast<std::size_t>(highest) + 1);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    of_ring[static_cast<std::size_t>(ring_of[i])].push_back(kept[i].point.z() / kept[i].range_m);
  }
  std::vector<std::pair<double, int>> by_elevation;
  for (std::size_t ring = 0; ring < of_ring.size(); ++ring) {
    if (!of_ring[ring].empty())
      by_elevation.emplace_back(std::asin(Median(of_ring[ring])), static_cast<int>(ring));
  }
  std::ranges::sort(by_elevation);

  ScanRings scan;
  std::vector<std::size_t> place(of_ring.size(), 0);
  scan.starts_.assign(1, 0);
  for (const auto& [elevation, ring] : by_elevation) {
    const auto k = static_cast<std::size_t>(ring);
    place[k] = scan.starts_.back();
    scan.starts_.push_back(place[k] + of_ring[k].size());
  }
  scan.points_.resize(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) {
    scan.points_[place[static_cast<std::size_t>(ring_of[i])]++] = kept[i];
  }
  std::vector<double> steps;
  steps.reserve(kept.size());
  for (int i = 0; i < scan.rings(); ++i) {
    const auto from = scan.points_.begin() + static_cast<std::ptrdiff_t>(scan.first(i));
    const auto to = scan.points_.begin() + static_cast<std::ptrdiff_t>(scan.first(i + 1));
    std::sort(from, to, [](const RingPoint& a, const RingPoint& b) {
      return a.azimuth_rad < b.azimuth_rad || (a.azimuth_rad == b.azimuth_rad && a.index < b.index);
    });
    for (auto it = from; it != to && it + 1 != to; ++it) {
      steps.push_back((it + 1)->azimuth_rad - it->azimuth_rad);
    }
  }
  scan.azimuth_step_rad_ = Median(steps);
  scan.range_sigma_m_ = RangeSigma(scan);
  steps.clear();
  for (std::size_t i = 1; i < by_elevation.size(); ++i) {
    steps.push_back(by_elevation[i].first - by_elevation[i - 1].first);
  }
  scan.elevation_step_rad_ = Median(steps);
  return scan;
}

}  // namespace sextant
