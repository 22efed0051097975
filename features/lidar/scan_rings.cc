// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/scan_rings.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/median.h"

namespace sextant {
namespace {

constexpr double kNearest_m = 0.01;  // Sensors write zeros for rays without a return.
constexpr int kMaxRings = 256;
constexpr int kMinRepeating = 4;  // Fewer rings are recognised by being narrow.
constexpr double kNarrow_rad = 0.0035;
constexpr double kNeighbour_cos = 0.99985;  // 1 degree.

// Rings from elevations that repeat: sorted elevations form steps separated by gaps. Beams that do
// not start at the origin spread the elevations of a ring, so a small gap may split one ring; the
// smallest gap is used for which no two rings are much closer than the median. Empty if elevations
// do not repeat, as in a rosette.
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
    if (lows.size() < kMinRepeating && widest < kNarrow_rad) return rings;
    if (lows.size() < kMinRepeating || lows.size() > kMaxRings) continue;
    std::vector<double> steps;
    for (std::size_t i = 1; i < lows.size(); ++i) steps.push_back(lows[i] - lows[i - 1]);
    const double min_step = *std::ranges::min_element(steps);
    const double median_step = UpperMedian(steps);
    if (min_step > 0.25 * median_step && widest < 0.5 * median_step) return rings;
  }
  return {};
}

// Bands of elevation, three times as high as the mean spacing of the points, because the loops of a
// rosette leave gaps.
struct Bands {
  std::vector<int> of_point;
  double height_rad = 0.0;
  double step_rad = 0.0;  // Solid angle per point divided by the height.
};

Bands BandsOf(const std::vector<RingPoint>& points, const std::vector<double>& elevations) {
  const auto [low, high] = std::ranges::minmax(elevations);
  const auto [left, right] = std::ranges::minmax(points, {}, &RingPoint::azimuth_rad);
  const double area = std::max((high - low) * (right.azimuth_rad - left.azimuth_rad), 1e-12);
  const double area_per_point = area / static_cast<double>(points.size());
  Bands bands;
  bands.height_rad = std::max(3.0 * std::sqrt(area_per_point), (high - low) / kMaxRings + 1e-9);
  bands.step_rad = area_per_point / bands.height_rad;
  bands.of_point.reserve(points.size());
  for (const double elevation : elevations) {
    bands.of_point.push_back(static_cast<int>((elevation - low) / bands.height_rad));
  }
  return bands;
}

// Whether each ring number corresponds to one elevation: half of a ring's returns lie within the
// step to the next ring (in the sine of the elevation, which suffices). The line numbers of a
// rosette do not, nor do the rings of a rotated cloud.
bool AreRings(const std::vector<int>& ring_of, const std::vector<double>& sines) {
  const int highest = *std::ranges::max_element(ring_of);
  std::vector<std::vector<double>> of_ring(static_cast<std::size_t>(highest) + 1);
  for (std::size_t i = 0; i < ring_of.size(); ++i) {
    of_ring[static_cast<std::size_t>(ring_of[i])].push_back(sines[i]);
  }
  std::vector<double> middles;
  std::vector<double> spreads;
  for (std::vector<double>& ring : of_ring) {
    if (ring.empty()) continue;
    middles.push_back(UpperMedian(ring));
    const auto middle = static_cast<std::ptrdiff_t>(ring.size() / 2);
    const auto quarter = static_cast<std::ptrdiff_t>(ring.size() / 4);
    std::nth_element(ring.begin(), ring.begin() + quarter, ring.begin() + middle);
    std::nth_element(ring.begin() + middle, ring.end() - 1 - quarter, ring.end());
    spreads.push_back(*(ring.end() - 1 - quarter) - ring[static_cast<std::size_t>(quarter)]);
  }
  std::ranges::sort(middles);
  std::vector<double> steps;
  for (std::size_t i = 1; i < middles.size(); ++i) steps.push_back(middles[i] - middles[i - 1]);
  return UpperMedian(spreads) < std::max(kNarrow_rad, UpperMedian(steps));
}

double SecondDifference(const RingPoint& a, const RingPoint& b, const RingPoint& c) {
  return std::abs(a.range_m - 2.0 * b.range_m + c.range_m);
}

bool AreNeighbours(const RingPoint& a, const RingPoint& b) {
  return a.point.dot(b.point) > kNeighbour_cos * a.range_m * b.range_m;
}

// On a flat surface the second difference of the range is noise alone, of sqrt 6 sigma; the median
// ignores the borders of objects. `swept`: the returns in the order of the cloud, in which those of
// a rosette are neighbours, unlike those of a band.
double RangeSigma(const ScanRings& scan, std::span<const RingPoint> swept) {
  constexpr double kSigmaOfMedian = 1.0 / 0.6745;
  std::vector<double> differences;
  if (!scan.has_rings()) {
    for (std::size_t i = 2; i < swept.size(); ++i) {
      if (AreNeighbours(swept[i - 2], swept[i - 1]) && AreNeighbours(swept[i - 1], swept[i])) {
        differences.push_back(SecondDifference(swept[i - 2], swept[i - 1], swept[i]));
      }
    }
    if (2 * differences.size() > swept.size()) {
      return kSigmaOfMedian * UpperMedian(differences) / std::sqrt(6.0);
    }
    differences.clear();
  }
  differences.reserve(scan.points().size());
  for (int ring = 0; ring < scan.rings(); ++ring) {
    const std::span<const RingPoint> points = scan.ring(ring);
    for (std::size_t i = 2; i < points.size(); ++i) {
      differences.push_back(SecondDifference(points[i - 2], points[i - 1], points[i]));
    }
  }
  return kSigmaOfMedian * UpperMedian(differences) / std::sqrt(6.0);
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
  std::vector<double> sines;
  sines.reserve(kept.size());
  for (const RingPoint& point : kept) sines.push_back(point.point.z() / point.range_m);
  ScanRings scan;
  Bands bands;
  scan.has_rings_ = !ring_of.empty() && AreRings(ring_of, sines);
  if (!scan.has_rings_) {
    std::vector<double> elevations = sines;
    for (double& elevation : elevations) elevation = std::asin(elevation);
    std::vector<int> repeating;
    if (ring_of.empty()) repeating = RingsOfElevations(elevations);
    scan.has_rings_ = !repeating.empty();
    if (!scan.has_rings_) bands = BandsOf(kept, elevations);
    ring_of = scan.has_rings_ ? std::move(repeating) : std::move(bands.of_point);
  }

  // Ring numbers may be sparse or descend with elevation, so rings are sorted by median elevation.
  // The median is taken of the sines, which have the same order.
  const int highest = *std::ranges::max_element(ring_of);
  std::vector<std::vector<double>> of_ring(static_cast<std::size_t>(highest) + 1);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    of_ring[static_cast<std::size_t>(ring_of[i])].push_back(sines[i]);
  }
  std::vector<std::pair<double, int>> by_elevation;
  for (std::size_t ring = 0; ring < of_ring.size(); ++ring) {
    if (!of_ring[ring].empty()) {
      by_elevation.emplace_back(std::asin(UpperMedian(of_ring[ring])), static_cast<int>(ring));
    }
  }
  std::ranges::sort(by_elevation);

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
  scan.azimuth_step_rad_ = scan.has_rings_ ? UpperMedian(steps) : bands.step_rad;
  scan.range_sigma_m_ = RangeSigma(scan, kept);
  steps.clear();
  for (std::size_t i = 1; i < by_elevation.size(); ++i) {
    steps.push_back(by_elevation[i].first - by_elevation[i - 1].first);
  }
  scan.elevation_step_rad_ = scan.has_rings_ ? UpperMedian(steps) : bands.height_rad;
  return scan;
}

int ScanRings::RingOf(std::size_t place) const {
  return static_cast<int>(std::ranges::upper_bound(starts_, place) - starts_.begin()) - 1;
}

}  // namespace sextant
