// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_turns.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/median.h"

namespace sextant {
namespace {

constexpr std::size_t kMinTurns = 4;
constexpr std::size_t kMaxTurns = 256;
constexpr std::size_t kMinPerTurn = 50;
constexpr double kMaxStep_rad = 0.012;
constexpr double kBack_rad = 0.1;     // A turn ends where the azimuth goes back by more.
constexpr double kAround_rad = 0.15;  // Around the first azimuth, where the next turn may begin.

double AzimuthOf(const UnsortedReturn& point) {
  return std::atan2(point.direction.y(), point.direction.x());
}

double Elevation(const UnsortedReturn& point) {
  return std::asin(std::clamp(point.direction.z(), -1.0, 1.0));
}

// From one azimuth to the next, in [-pi, pi].
double Turned(double from_rad, double to_rad) {
  return std::remainder(to_rad - from_rad, 2.0 * std::numbers::pi);
}

// 1 if azimuths ascend, -1 if they descend; 0 where neighbours are too far apart to be of one ring.
double SenseOfTurning(std::span<const UnsortedReturn> returns) {
  std::vector<double> steps;
  std::ptrdiff_t ascending = 0;
  for (std::size_t i = 1; i < returns.size(); ++i) {
    ascending += Turned(AzimuthOf(returns[i - 1]), AzimuthOf(returns[i])) > 0.0 ? 1 : -1;
    if (i % 16 == 0) steps.push_back((returns[i].direction - returns[i - 1].direction).norm());
  }
  if (steps.empty() || UpperMedian(steps) > kMaxStep_rad) return 0.0;
  return ascending > 0 ? 1.0 : -1.0;
}

// The return near `around` at which the elevation steps most: the lasers of a sensor begin their
// turns at slightly different azimuths.
std::size_t BeginNear(std::span<const UnsortedReturn> returns, std::size_t around,
                      std::size_t after) {
  const double azimuth = AzimuthOf(returns[around]);
  const auto is_near = [&](std::size_t i) {
    return std::abs(Turned(azimuth, AzimuthOf(returns[i]))) < kAround_rad;
  };
  std::size_t best = around;
  double largest = 0.0;
  const auto consider = [&](std::size_t i) {
    const double step = std::abs(Elevation(returns[i]) - Elevation(returns[i - 1]));
    if (step > largest) {
      largest = step;
      best = i;
    }
  };
  for (std::size_t i = around; i > after + 1 && is_near(i); --i) consider(i);
  for (std::size_t i = around + 1; i < returns.size() && is_near(i); ++i) consider(i);
  return best;
}

// The first return of each turn, and the number of returns at the end.
std::vector<std::size_t> StartsOfTurns(std::span<const UnsortedReturn> returns, double sense) {
  std::vector<std::size_t> starts = {0};
  const double first = AzimuthOf(returns[0]);
  double turned = 0.0;  // Since the first azimuth.
  double farthest = 0.0;
  for (std::size_t i = 1; i < returns.size(); ++i) {
    const double step = sense * Turned(AzimuthOf(returns[i - 1]), AzimuthOf(returns[i]));
    turned += step;
    farthest = std::max(farthest, turned);
    const bool whole = turned >= 2.0 * std::numbers::pi;
    const bool back = step < -kBack_rad && turned < 0.5 * farthest;
    if ((!whole && !back) || i < starts.back() + kMinPerTurn) continue;
    const std::size_t begin = whole ? BeginNear(returns, i, starts.back()) : i;
    if (begin < starts.back() + kMinPerTurn) continue;
    starts.push_back(begin);
    if (starts.size() > kMaxTurns) return {};
    turned = sense * Turned(first, AzimuthOf(returns[i]));
    farthest = turned;
  }
  starts.push_back(returns.size());
  return starts;
}

double MedianElevation(std::span<const UnsortedReturn> returns) {
  std::vector<double> elevations;
  for (const UnsortedReturn& point : returns) elevations.push_back(Elevation(point));
  return UpperMedian(elevations);
}

// Whether the beginnings and ends of nearly all turns differ by less than the turns do among
// themselves: halves of two rings do not.
bool AreOfOneElevation(std::span<const UnsortedReturn> returns,
                       const std::vector<std::size_t>& starts) {
  constexpr double kMinShare = 0.8;
  std::vector<double> middles;
  std::vector<double> differences;
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    const std::span<const UnsortedReturn> turn =
        returns.subspan(starts[k], starts[k + 1] - starts[k]);
    const std::size_t third = turn.size() / 3;
    if (third == 0) return false;
    middles.push_back(MedianElevation(turn));
    differences.push_back(
        std::abs(MedianElevation(turn.first(third)) - MedianElevation(turn.last(third))));
  }
  std::vector<double> steps;
  for (std::size_t k = 1; k < middles.size(); ++k) {
    steps.push_back(std::abs(middles[k] - middles[k - 1]));
  }
  const double allowed = 0.5 * UpperMedian(steps);
  const auto same = std::ranges::count_if(differences, [&](double d) { return d < allowed; });
  return static_cast<double>(same) >= kMinShare * static_cast<double>(differences.size());
}

}  // namespace

std::vector<int> RingsByTurns(std::span<const UnsortedReturn> returns) {
  const double sense = SenseOfTurning(returns);
  if (sense == 0.0) return {};
  const std::vector<std::size_t> starts = StartsOfTurns(returns, sense);
  if (starts.size() <= kMinTurns || !AreOfOneElevation(returns, starts)) return {};
  std::vector<int> numbers;
  numbers.reserve(returns.size());
  for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
    numbers.resize(starts[k + 1], static_cast<int>(k));
  }
  return numbers;
}

}  // namespace sextant
