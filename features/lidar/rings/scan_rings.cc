// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/scan_rings.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/median.h"
#include "features/lidar/rings/ring_numbers.h"

namespace sextant {
namespace {

constexpr double kNearest_m = 0.01;  // Sensors write zeros for rays without a return.
constexpr int kMaxBands = 256;
constexpr double kNeighbour_cos = 0.99985;  // 1 degree.

// Bands of elevation, three times as high as the mean spacing of the points, because the loops of a
// rosette leave gaps.
struct Bands {
  std::vector<int> of_point;
  double height_rad = 0.0;
  double step_rad = 0.0;  // Solid angle per point divided by the height.
};

Bands BandsOf(const std::vector<RingPoint>& points) {
  std::vector<double> elevations;
  elevations.reserve(points.size());
  for (const RingPoint& point : points) elevations.push_back(std::asin(point.sine));
  const auto [low, high] = std::ranges::minmax(elevations);
  const auto [left, right] = std::ranges::minmax(points, {}, &RingPoint::azimuth_rad);
  const double area = std::max((high - low) * (right.azimuth_rad - left.azimuth_rad), 1e-12);
  const double area_per_point = area / static_cast<double>(points.size());
  Bands bands;
  bands.height_rad = std::max(3.0 * std::sqrt(area_per_point), (high - low) / kMaxBands + 1e-9);
  bands.step_rad = area_per_point / bands.height_rad;
  bands.of_point.reserve(points.size());
  for (const double elevation : elevations) {
    bands.of_point.push_back(static_cast<int>((elevation - low) / bands.height_rad));
  }
  return bands;
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

// The finite returns, as far as the sensor does not report zeros.
std::vector<UnsortedReturn> ReturnsOf(const PointCloud& cloud) {
  std::vector<UnsortedReturn> returns;
  returns.reserve(cloud.points.size());
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const double range = cloud.points[i].norm();
    if (!std::isfinite(range) || range < kNearest_m) continue;
    returns.push_back({cloud.points[i] / range, range, i});
  }
  return returns;
}

RingNumbers RingsOf(const PointCloud& cloud, const std::vector<UnsortedReturn>& returns) {
  if (cloud.ring.empty()) return RecoverRings(returns, cloud.points.size());
  std::vector<int> numbers;
  numbers.reserve(returns.size());
  for (const UnsortedReturn& point : returns) numbers.push_back(cloud.ring[point.index]);
  // Converters that do not know the ring write the same number, mostly 0, for every point.
  const bool is_one = std::ranges::count(numbers, numbers.front()) == std::ssize(numbers);
  RingNumbers rings = CheckRings(returns, std::move(numbers));
  if (is_one && rings.of_return.empty()) return RecoverRings(returns, cloud.points.size());
  return rings;
}

// The numbers of the rings that have returns, from the lowest up. Numbers may be sparse or descend
// with elevation, so rings are sorted by median elevation, unless they are so wide that medians do
// not order them. The median is taken of the sines, which have the same order.
std::vector<int> FromTheLowest(const std::vector<RingPoint>& points, const RingNumbers& numbers) {
  const int highest = *std::ranges::max_element(numbers.of_return);
  std::vector<std::vector<double>> of_ring(static_cast<std::size_t>(highest) + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    of_ring[static_cast<std::size_t>(numbers.of_return[i])].push_back(points[i].sine);
  }
  std::vector<std::pair<double, int>> by_elevation;
  for (int ring = 0; ring <= highest; ++ring) {
    std::vector<double>& sines = of_ring[static_cast<std::size_t>(ring)];
    if (!sines.empty()) by_elevation.emplace_back(UpperMedian(sines), ring);
  }
  if (!numbers.ascend) std::ranges::sort(by_elevation);
  std::vector<int> from_the_lowest;
  for (const auto& [sine, ring] : by_elevation) from_the_lowest.push_back(ring);
  return from_the_lowest;
}

// The rotation that takes the axis to z; x stays as it is as far as possible.
Eigen::Matrix3d LevelFrom(const Eigen::Vector3d& axis) {
  if (axis == Eigen::Vector3d::UnitZ()) return Eigen::Matrix3d::Identity();
  return Eigen::Quaterniond::FromTwoVectors(axis, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

}  // namespace

Expected<ScanRings> ScanRings::Build(const PointCloud& cloud) {
  const std::size_t count = cloud.points.size();
  if (!cloud.ring.empty() && cloud.ring.size() != count) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("the scan has {} points but {} ring numbers", count, cloud.ring.size()));
  }
  const std::vector<UnsortedReturn> returns = ReturnsOf(cloud);
  if (returns.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("none of the scan's {} points is a finite return", count));
  }
  RingNumbers numbers = RingsOf(cloud, returns);
  ScanRings scan;
  scan.level_from_lidar_ = LevelFrom(numbers.axis);
  std::vector<RingPoint> points;
  points.reserve(returns.size());
  for (const UnsortedReturn& of : returns) {
    const Eigen::Vector3d& point = cloud.points[of.index];
    points.push_back({point, of.range_m, scan.AzimuthOf(point), numbers.axis.dot(of.direction),
                      static_cast<int>(of.index)});
  }
  scan.has_rings_ = !numbers.of_return.empty();
  Bands bands;
  if (!scan.has_rings_) {
    bands = BandsOf(points);
    numbers.of_return = bands.of_point;
  }
  scan.numbers_ = FromTheLowest(points, numbers);
  scan.SortByRing(points, numbers.of_return);
  scan.MeasureSteps();
  if (!scan.has_rings_) {
    scan.azimuth_step_rad_ = bands.step_rad;
    scan.elevation_step_rad_ = bands.height_rad;
  }
  scan.range_sigma_m_ = RangeSigma(scan, points);
  return scan;
}

// Sorts the points by the rings of numbers_, and each ring by azimuth.
void ScanRings::SortByRing(const std::vector<RingPoint>& points, const std::vector<int>& ring_of) {
  std::vector<std::size_t> place(1U + static_cast<std::size_t>(std::ranges::max(ring_of)), 0);
  for (const int ring : ring_of) ++place[static_cast<std::size_t>(ring)];
  starts_.assign(1, 0);
  for (const int number : numbers_) {
    const std::size_t count =
        std::exchange(place[static_cast<std::size_t>(number)], starts_.back());
    starts_.push_back(starts_.back() + count);
  }
  points_.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points_[place[static_cast<std::size_t>(ring_of[i])]++] = points[i];
  }
  for (int i = 0; i < rings(); ++i) {
    const auto from = points_.begin() + static_cast<std::ptrdiff_t>(first(i));
    const auto to = points_.begin() + static_cast<std::ptrdiff_t>(first(i + 1));
    std::sort(from, to, [](const RingPoint& a, const RingPoint& b) {
      return a.azimuth_rad < b.azimuth_rad || (a.azimuth_rad == b.azimuth_rad && a.index < b.index);
    });
  }
}

void ScanRings::MeasureSteps() {
  std::vector<double> steps;
  std::vector<double> elevations;
  steps.reserve(points_.size());
  for (int i = 0; i < rings(); ++i) {
    std::vector<double> sines;
    for (std::size_t k = first(i); k < first(i + 1); ++k) {
      if (k > first(i)) steps.push_back(points_[k].azimuth_rad - points_[k - 1].azimuth_rad);
      sines.push_back(points_[k].sine);
    }
    elevations.push_back(std::asin(UpperMedian(sines)));
  }
  azimuth_step_rad_ = UpperMedian(steps);
  steps.clear();
  for (std::size_t i = 1; i < elevations.size(); ++i) {
    steps.push_back(elevations[i] - elevations[i - 1]);
  }
  elevation_step_rad_ = UpperMedian(steps);
}

int ScanRings::RingOf(std::size_t place) const {
  return static_cast<int>(std::ranges::upper_bound(starts_, place) - starts_.begin()) - 1;
}

}  // namespace sextant
