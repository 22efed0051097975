// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_numbers.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "base/median.h"
#include "base/units.h"
#include "features/lidar/rings/ring_following.h"
#include "features/lidar/rings/ring_order.h"
#include "features/lidar/rings/ring_turns.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr int kMaxRings = 256;
constexpr int kMinRepeating = 4;  // Fewer rings are recognised by being narrow.
constexpr double kNarrow_rad = 0.0035;
constexpr std::size_t kMinPerRing = 3;  // Fewer returns do not show that elevations repeat.
constexpr double kNarrowShare = 0.95;   // Share of the returns on rings narrower than their gaps.
constexpr double kMinTilt_rad = 0.005;  // A smaller tilt of the axis is noise.

std::vector<double> ElevationsAbout(std::span<const UnsortedReturn> returns,
                                    const Eigen::Vector3d& axis) {
  std::vector<double> elevations;
  elevations.reserve(returns.size());
  for (const UnsortedReturn& point : returns) {
    elevations.push_back(std::asin(std::clamp(axis.dot(point.direction), -1.0, 1.0)));
  }
  return elevations;
}

std::vector<std::size_t> OrderOf(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return values[i]; });
  return order;
}

// How narrow the rings are compared with their distances.
struct RingSpread {
  double spread_rad = 0.0;  // Median of the interquartile ranges of the rings' elevations.
  double step_rad = 0.0;    // Median distance of neighbouring rings.
};

RingSpread SpreadOf(const std::vector<int>& numbers, const std::vector<double>& elevations) {
  const int highest = *std::ranges::max_element(numbers);
  std::vector<std::vector<double>> of_ring(static_cast<std::size_t>(highest) + 1);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    if (numbers[i] >= 0) of_ring[static_cast<std::size_t>(numbers[i])].push_back(elevations[i]);
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
  return {UpperMedian(spreads), UpperMedian(steps)};
}

bool AreRings(const RingSpread& spread) {
  return spread.spread_rad < std::max(kNarrow_rad, spread.step_rad);
}

// The direction about which the returns of each ring form a cone: the direction in which their
// directions vary least about the ring's mean.
Eigen::Vector3d SpinAxis(std::span<const UnsortedReturn> returns, const std::vector<int>& numbers) {
  const auto rings = static_cast<std::size_t>(*std::ranges::max_element(numbers)) + 1;
  std::vector<Eigen::Vector3d> sums(rings, Eigen::Vector3d::Zero());
  std::vector<double> counts(rings, 0.0);
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Eigen::Vector3d& direction = returns[i].direction;
    sums[static_cast<std::size_t>(numbers[i])] += direction;
    counts[static_cast<std::size_t>(numbers[i])] += 1.0;
    scatter += direction * direction.transpose();
  }
  for (std::size_t ring = 0; ring < rings; ++ring) {
    if (counts[ring] > 0.0) scatter -= sums[ring] * sums[ring].transpose() / counts[ring];
  }
  const Eigen::Vector3d axis = EigenOf(scatter).vectors.col(0);
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  return axis(largest) < 0.0 ? Eigen::Vector3d(-axis) : axis;
}

// Sorted elevations form steps separated by gaps. The smallest gap is used for which nearly all
// returns are on rings narrower than half the distance to their neighbours.
std::vector<int> RingsByGap(const std::vector<double>& elevations,
                            const std::vector<std::size_t>& order, double gap_rad) {
  std::vector<int> rings(elevations.size(), 0);
  std::vector<std::size_t> starts = {0};
  for (std::size_t i = 1; i < order.size(); ++i) {
    if (elevations[order[i]] - elevations[order[i - 1]] > gap_rad) starts.push_back(i);
    rings[order[i]] = static_cast<int>(starts.size()) - 1;
  }
  const std::size_t count = starts.size();
  starts.push_back(order.size());
  const auto low = [&](std::size_t k) { return elevations[order[starts[k]]]; };
  const auto high = [&](std::size_t k) { return elevations[order[starts[k + 1] - 1]]; };
  if (count < kMinRepeating) {
    for (std::size_t k = 0; k < count; ++k) {
      if (high(k) - low(k) >= kNarrow_rad) return {};
    }
    return rings;
  }
  if (count > kMaxRings || kMinPerRing * count > order.size()) return {};
  std::size_t narrow = 0;
  for (std::size_t k = 0; k < count; ++k) {
    double gap = std::numeric_limits<double>::infinity();
    if (k > 0) gap = std::min(gap, low(k) - high(k - 1));
    if (k + 1 < count) gap = std::min(gap, low(k + 1) - high(k));
    if (high(k) - low(k) < 0.5 * gap) narrow += starts[k + 1] - starts[k];
  }
  const bool found =
      static_cast<double>(narrow) >= kNarrowShare * static_cast<double>(order.size());
  return found ? rings : std::vector<int>{};
}

std::vector<int> RingsOfElevations(const std::vector<double>& elevations,
                                   const std::vector<std::size_t>& order) {
  for (const double gap_deg : {0.02, 0.05, 0.1, 0.2, 0.4, 0.8}) {
    std::vector<int> rings = RingsByGap(elevations, order, gap_deg * kRadPerDeg);
    if (!rings.empty()) return rings;
  }
  return {};
}

// Whether some neighbouring rings share nearly no azimuth, as the far and the near returns of one
// ring whose beam starts beside the origin.
bool SomeAreSplit(std::span<const UnsortedReturn> returns, const std::vector<int>& numbers) {
  constexpr std::size_t kBins = 720;
  constexpr double kMinShared = 0.1;
  const auto rings = static_cast<std::size_t>(*std::ranges::max_element(numbers)) + 1;
  std::vector<std::bitset<kBins>> azimuths(rings);
  for (std::size_t i = 0; i < returns.size(); ++i) {
    const Eigen::Vector3d& direction = returns[i].direction;
    const double turn = 0.5 + std::atan2(direction.y(), direction.x()) / (2.0 * std::numbers::pi);
    const auto bin = std::min(kBins - 1, static_cast<std::size_t>(turn * kBins));
    azimuths[static_cast<std::size_t>(numbers[i])].set(bin);
  }
  for (std::size_t ring = 1; ring < rings; ++ring) {
    const std::size_t fewest = std::min(azimuths[ring - 1].count(), azimuths[ring].count());
    const std::size_t shared = (azimuths[ring - 1] & azimuths[ring]).count();
    if (static_cast<double>(shared) < kMinShared * static_cast<double>(fewest)) return true;
  }
  return false;
}

}  // namespace

RingNumbers CheckRings(std::span<const UnsortedReturn> returns, std::vector<int> numbers) {
  const RingSpread about_z = SpreadOf(numbers, ElevationsAbout(returns, Eigen::Vector3d::UnitZ()));
  RingNumbers rings;
  const Eigen::Vector3d axis = SpinAxis(returns, numbers);
  const double tilt = std::acos(std::clamp(axis.z(), -1.0, 1.0));
  if (tilt > kMinTilt_rad) {
    const RingSpread about_axis = SpreadOf(numbers, ElevationsAbout(returns, axis));
    if (AreRings(about_axis) && about_axis.spread_rad < 0.5 * about_z.spread_rad &&
        about_z.spread_rad > kNarrow_rad) {
      return {.of_return = std::move(numbers), .axis = axis};
    }
  }
  if (AreRings(about_z)) rings.of_return = std::move(numbers);
  return rings;
}

RingNumbers RecoverRings(std::span<const UnsortedReturn> returns, std::size_t cloud_size) {
  const std::vector<double> elevations = ElevationsAbout(returns, Eigen::Vector3d::UnitZ());
  RingNumbers rings;
  std::vector<int> repeating = RingsOfElevations(elevations, OrderOf(elevations));
  if (!repeating.empty() && !SomeAreSplit(returns, repeating)) {
    rings.of_return = std::move(repeating);
    return rings;
  }
  if (std::vector<int> numbers = RingsByOrder(returns, cloud_size); !numbers.empty()) {
    rings = CheckRings(returns, std::move(numbers));
    if (!rings.of_return.empty()) return rings;
  }
  rings.of_return = RingsByTurns(returns);
  rings.ascend = !rings.of_return.empty();
  if (rings.of_return.empty()) rings.of_return = RingsByFollowing(returns);
  if (rings.of_return.empty()) rings.of_return = std::move(repeating);
  return rings;
}

}  // namespace sextant
