// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <utility>

#include "base/median.h"
#include "base/units.h"
#include "features/lidar/rings/ring_line.h"

namespace sextant {
namespace {

constexpr std::size_t kMinTurns = 16;
constexpr std::size_t kMaxTurns = 128;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kMaxBackward_rad = 20.0 * kRadPerDeg;  // Near returns of a beam beside the axis.
constexpr double kMaxPartial = 0.25;  // Share of the turns that miss half a turn or more.
constexpr double kMinStepping = 0.5;  // Share of the turns that begin with a step in elevation.
constexpr double kMinStep = 0.5;      // Relative to the step to the next ring.
constexpr double kMaxStep = 1.5;
constexpr double kMinOrdered = 0.9;  // Share of the compared returns of two neighbouring turns.
constexpr std::size_t kMinCompared = 16;
constexpr double kEqualNearness = 0.01;  // [1/m]; 0.1 degrees for a beam 0.2 m off the origin.

// From one direction to the next, about z, in [-pi, pi].
double StepBetween(const UnsortedReturn& last, const UnsortedReturn& now) {
  const Eigen::Vector2d a = last.direction.head<2>();
  const Eigen::Vector2d b = now.direction.head<2>();
  return std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b));
}

// The sense in which most azimuths run on: 1 or -1.
double SenseOf(std::span<const UnsortedReturn> returns) {
  std::ptrdiff_t sum = 0;
  for (std::size_t i = 1; i < returns.size(); ++i) {
    const double step = StepBetween(returns[i - 1], returns[i]);
    sum += (step > 0.0 ? 1 : 0) - (step < 0.0 ? 1 : 0);
  }
  return sum < 0 ? -1.0 : 1.0;
}

// A return of a list that turns in one sense.
struct TurningPlace {
  double turned_rad = 0.0;  // Since the list's first return.
  ConePlace cone{};
};

struct TurningList {
  std::vector<TurningPlace> places{};
  std::size_t turns = 0;
  double unseen_rad = 0.0;  // The first turn begins at most so much before the first return.
};

// None unless the list turns often enough, and most turns go round.
std::optional<TurningList> FindTurning(std::span<const UnsortedReturn> returns) {
  const double sense = SenseOf(returns);
  TurningList list{.places = {{0.0, ConePlace::Of(returns.front())}}};
  list.places.reserve(returns.size());
  std::size_t partial = 0;
  double turned = 0.0;
  for (std::size_t i = 1; i < returns.size(); ++i) {
    const double step = sense * StepBetween(returns[i - 1], returns[i]);
    const bool is_wide = step < -kMaxBackward_rad;  // More than half a turn forward.
    partial += is_wide ? 1U : 0U;
    turned += is_wide ? step + kTurn_rad : step;
    list.places.push_back({turned, ConePlace::Of(returns[i])});
  }
  const double turns = std::floor(turned / kTurn_rad) + 1.0;
  list.turns = static_cast<std::size_t>(std::max(turns, 0.0));
  list.unseen_rad = turns * kTurn_rad - turned;
  if (list.turns < kMinTurns || list.turns > kMaxTurns) return std::nullopt;
  if (static_cast<double>(partial) > kMaxPartial * turns) return std::nullopt;
  return list;
}

// The turn of each return, if the first begins `before_rad` before the first return.
std::vector<int> NumbersOf(std::span<const TurningPlace> places, double before_rad) {
  std::vector<int> numbers;
  numbers.reserve(places.size());
  int turn = 0;
  for (const TurningPlace& place : places) {
    // A step back does not end a turn that has begun.
    turn = std::max(turn, static_cast<int>((place.turned_rad + before_rad) / kTurn_rad));
    numbers.push_back(turn);
  }
  return numbers;
}

constexpr std::size_t kTurnBins = 720;
using TurnByAzimuth = std::array<const ConePlace*, kTurnBins>;

std::vector<TurnByAzimuth> ByAzimuth(std::span<const TurningPlace> places, std::size_t turns) {
  const std::vector<int> numbers = NumbersOf(places, 0.0);
  std::vector<TurnByAzimuth> by_azimuth(turns, TurnByAzimuth{});
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double share = places[i].turned_rad / kTurn_rad - numbers[i];
    const auto bin = static_cast<std::size_t>(std::max(share, 0.0) * kTurnBins);
    by_azimuth[static_cast<std::size_t>(numbers[i])][std::min(kTurnBins - 1, bin)] =
        &places[i].cone;
  }
  return by_azimuth;
}

// The median step in tangent between two turns at the same azimuth and distance; none unless they
// are ordered.
std::optional<double> OrderedStep(const TurnByAzimuth& last, const TurnByAzimuth& now) {
  std::vector<double> steps;
  for (std::size_t k = 0; k < kTurnBins; ++k) {
    if (last[k] == nullptr || now[k] == nullptr) continue;
    if (std::abs(now[k]->nearness - last[k]->nearness) > kEqualNearness) continue;
    steps.push_back(now[k]->tangent - last[k]->tangent);
  }
  if (steps.size() < kMinCompared) return std::nullopt;
  const double median = UpperMedian(steps);
  const auto ordered = std::ranges::count_if(steps, [&](double s) { return s * median > 0.0; });
  const bool are_ordered =
      static_cast<double>(ordered) >= kMinOrdered * static_cast<double>(steps.size());
  return are_ordered ? std::optional(median) : std::nullopt;
}

// The step from each turn to the next; empty unless all are up or all are down. It does not matter
// where turns begin: at every azimuth, a turn later is the next ring.
std::vector<double> StepsOfTurns(std::span<const TurningPlace> places, std::size_t turns) {
  const std::vector<TurnByAzimuth> by_azimuth = ByAzimuth(places, turns);
  std::vector<double> steps;
  for (std::size_t i = 1; i < turns; ++i) {
    const std::optional<double> step = OrderedStep(by_azimuth[i - 1], by_azimuth[i]);
    if (!step || (!steps.empty() && *step * steps.front() < 0.0)) return {};
    steps.push_back(*step);
  }
  return steps;
}

// How far before the first return the turns begin: where most of them step to the next ring.
std::optional<double> FindStart(std::span<const TurningPlace> places, double unseen_rad,
                                std::span<const double> steps) {
  std::vector<std::pair<double, int>> changes;  // In the number of turns that step, by the start.
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double turn = std::ceil(places[i - 1].turned_rad / kTurn_rad);
    if (turn < 1.0 || turn > static_cast<double>(steps.size())) continue;
    const double low = std::max(turn * kTurn_rad - places[i].turned_rad, 0.0);
    const double high = std::min(turn * kTurn_rad - places[i - 1].turned_rad, unseen_rad);
    const double whole = steps[static_cast<std::size_t>(turn) - 1];
    const double step = (places[i].cone.tangent - places[i - 1].cone.tangent) / whole;
    if (low >= high || step < kMinStep || step > kMaxStep) continue;
    changes.emplace_back(low, 1);
    changes.emplace_back(high, -1);
  }
  std::ranges::sort(changes);
  int stepping = 0;
  int most = 0;
  double start = 0.0;
  for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
    stepping += changes[i].second;
    if (stepping <= most) continue;
    most = stepping;
    start = 0.5 * (changes[i].first + changes[i + 1].first);
  }
  const bool begin = most >= kMinStepping * static_cast<double>(steps.size());
  return begin ? std::optional(start) : std::nullopt;
}

}  // namespace

std::vector<int> RingsByTurns(std::span<const UnsortedReturn> returns) {
  const std::optional<TurningList> list = FindTurning(returns);
  if (!list) return {};
  const std::vector<double> steps = StepsOfTurns(list->places, list->turns);
  if (steps.empty()) return {};
  const std::optional<double> start = FindStart(list->places, list->unseen_rad, steps);
  if (!start) return {};
  std::vector<int> numbers = NumbersOf(list->places, *start);
  if (steps.front() < 0.0) {
    for (int& number : numbers) number = static_cast<int>(steps.size()) - number;
  }
  return numbers;
}

}  // namespace sextant
