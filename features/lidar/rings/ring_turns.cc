// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_turns.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <optional>

#include "base/median.h"
#include "base/units.h"
#include "features/lidar/rings/ring_line.h"

namespace sextant {
namespace {

constexpr std::size_t kMinTurns = 16;
constexpr std::size_t kMaxTurns = 128;
constexpr double kTurn_rad = 2.0 * std::numbers::pi;
constexpr double kMaxBackward = 0.05;  // Of the steps; near returns of a beam beside the axis.
constexpr double kMaxBackward_rad = 20.0 * kRadPerDeg;
constexpr double kMaxUnseen_rad = 90.0 * kRadPerDeg;
constexpr double kStartStep_rad = 0.02 * kRadPerDeg;
constexpr double kMinStepping = 0.7;  // Of the turns, that begin with a step in elevation.
constexpr double kMinOrdered = 0.9;   // Of the compared returns of two neighbouring turns.
constexpr std::size_t kMinCompared = 16;
constexpr double kEqualNearness = 0.01;  // [1/m]; 0.1 degrees for a beam 0.2 m off the origin.

// A return of a list that turns in one sense.
struct TurningPlace {
  double turned_rad = 0.0;  // Since the list's first return.
  ConePlace cone{};
};

// Empty unless the azimuths run on in one sense, but for a few steps.
std::vector<TurningPlace> PlacesOfTurning(std::span<const UnsortedReturn> returns) {
  std::vector<TurningPlace> places = {{0.0, ConePlace::Of(returns.front())}};
  places.reserve(returns.size());
  std::size_t positive = 0;
  std::size_t negative = 0;
  double widest_positive = 0.0;
  double widest_negative = 0.0;
  for (std::size_t i = 1; i < returns.size(); ++i) {
    const Eigen::Vector3d& last = returns[i - 1].direction;
    const Eigen::Vector3d& now = returns[i].direction;
    const double step = std::atan2(last.x() * now.y() - last.y() * now.x(),
                                   last.x() * now.x() + last.y() * now.y());
    positive += step > 0.0 ? 1U : 0U;
    negative += step < 0.0 ? 1U : 0U;
    widest_positive = std::max(widest_positive, step);
    widest_negative = std::max(widest_negative, -step);
    places.push_back({places.back().turned_rad + step, ConePlace::Of(returns[i])});
  }
  const bool is_clockwise = negative > positive;
  const auto most = static_cast<double>(std::max(positive, negative));
  const double backward_rad = is_clockwise ? widest_positive : widest_negative;
  const bool run_on = most >= (1.0 - kMaxBackward) * static_cast<double>(returns.size() - 1);
  if (!run_on || backward_rad > kMaxBackward_rad) return {};
  if (is_clockwise) {
    for (TurningPlace& place : places) place.turned_rad = -place.turned_rad;
  }
  return places;
}

// The turns of a list, the first of which begins up to `unseen_rad` before the first return.
struct TurnSpan {
  std::size_t count = 0;
  double unseen_rad = 0.0;
};

std::optional<TurnSpan> WholeTurns(std::span<const TurningPlace> places) {
  if (places.empty()) return std::nullopt;
  const double turned = places.back().turned_rad;
  const double count = std::floor(turned / kTurn_rad) + 1.0;
  const TurnSpan turns{static_cast<std::size_t>(std::max(count, 0.0)), count * kTurn_rad - turned};
  const bool are_rings = turns.count >= kMinTurns && turns.count <= kMaxTurns;
  if (!are_rings || turns.unseen_rad > kMaxUnseen_rad) return std::nullopt;
  return turns;
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

// How far before the first return the turns begin: where most of them step by half the distance to
// the next ring or more.
std::optional<double> FindStart(std::span<const TurningPlace> places, double unseen_rad,
                                std::span<const double> steps) {
  const auto cells = static_cast<std::size_t>(std::ceil(unseen_rad / kStartStep_rad));
  const auto cell_of = [&](double before_rad) {
    const double cell = std::ceil(before_rad / kStartStep_rad);
    return static_cast<std::size_t>(std::clamp(cell, 0.0, static_cast<double>(cells)));
  };
  std::vector<int> changes(cells + 1, 0);  // Of the number of turns that step, by cell.
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double last = places[i - 1].turned_rad;
    const double now = places[i].turned_rad;
    const double turn = std::ceil(last / kTurn_rad);
    if (now <= last || turn < 1.0 || turn > static_cast<double>(steps.size())) continue;
    const double whole = steps[static_cast<std::size_t>(turn) - 1];
    if ((places[i].cone.tangent - places[i - 1].cone.tangent) / whole < 0.5) continue;
    ++changes[cell_of(turn * kTurn_rad - now)];
    --changes[cell_of(turn * kTurn_rad - last)];
  }
  std::vector<int> stepping(cells);
  std::partial_sum(changes.begin(), changes.end() - 1, stepping.begin());
  const auto most = std::ranges::max_element(stepping);
  if (*most < kMinStepping * static_cast<double>(steps.size())) return std::nullopt;
  const auto end = std::find_if(most, stepping.end(), [&](int count) { return count < *most; });
  const auto middle = (most - stepping.begin()) + (end - most - 1) / 2;
  return static_cast<double>(middle) * kStartStep_rad;
}

}  // namespace

std::vector<int> RingsByTurns(std::span<const UnsortedReturn> returns) {
  const std::vector<TurningPlace> places = PlacesOfTurning(returns);
  const std::optional<TurnSpan> turns = WholeTurns(places);
  if (!turns) return {};
  const std::vector<double> steps = StepsOfTurns(places, turns->count);
  if (steps.empty()) return {};
  const std::optional<double> start = FindStart(places, turns->unseen_rad, steps);
  return start ? NumbersOf(places, *start) : std::vector<int>{};
}

}  // namespace sextant
