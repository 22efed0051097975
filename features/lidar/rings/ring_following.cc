// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/rings/ring_following.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "base/units.h"
#include "features/lidar/rings/ring_line.h"

namespace sextant {
namespace {

constexpr std::size_t kMinFollowed = 4;
constexpr std::size_t kMaxFollowed = 256;
constexpr std::size_t kMinOfFollowed = 3;  // Fewer returns do not show that elevations repeat.
constexpr double kMaxAmbiguous = 0.05;     // Share of the returns.
constexpr double kClear = 0.001;           // Share of the returns; so few need no other tolerance.
constexpr double kClearlyNearer = 0.3;     // Distance to a ring relative to that to the next.

// Predicts the elevation of a ring's next return from the ring's line.
class FarToNear {
 public:
  static double Key(const ConePlace& place, const UnsortedReturn& /*point*/) {
    return place.nearness;
  }
  void Add(const ConePlace& place) { line_.Add(place); }
  double ElevationAt(const ConePlace& place) const {
    return std::atan(line_.TangentAt(place.nearness));
  }

 private:
  RingLine line_;
};

// Expects it to be that of the last return.
class AlongAzimuth {
 public:
  static double Key(const ConePlace& /*place*/, const UnsortedReturn& point) {
    return std::atan2(point.direction.y(), point.direction.x());
  }
  void Add(const ConePlace& place) { elevation_ = std::atan(place.tangent); }
  double ElevationAt(const ConePlace& /*place*/) const { return elevation_; }

 private:
  double elevation_ = 0.0;
};

struct Followed {
  std::vector<int> numbers{};
  std::size_t ambiguous = 0;
};

// Each return continues the nearest ring within the tolerance, or begins another. Empty if that is
// ambiguous for too many.
template <typename Ring>
Followed Follow(const std::vector<ConePlace>& places, const std::vector<std::size_t>& order,
                double tolerance_rad) {
  const double allowed = kMaxAmbiguous * static_cast<double>(order.size());
  std::vector<Ring> rings;
  Followed followed{.numbers = std::vector<int>(places.size(), 0)};
  for (const std::size_t i : order) {
    const double elevation = std::atan(places[i].tangent);
    std::size_t ring = rings.size();
    double nearest = std::numeric_limits<double>::infinity();
    double second = nearest;
    for (std::size_t k = 0; k < rings.size(); ++k) {
      const double off = std::abs(rings[k].ElevationAt(places[i]) - elevation);
      if (off < nearest) {
        second = std::exchange(nearest, off);
        ring = k;
      } else {
        second = std::min(second, off);
      }
    }
    if (nearest > tolerance_rad) {
      followed.ambiguous += nearest < 2.0 * tolerance_rad ? 1U : 0U;
      ring = rings.size();
      rings.emplace_back();
    } else {
      followed.ambiguous += nearest > kClearlyNearer * second ? 1U : 0U;
    }
    rings[ring].Add(places[i]);
    followed.numbers[i] = static_cast<int>(ring);
    if (rings.size() > kMaxFollowed || static_cast<double>(followed.ambiguous) > allowed) return {};
  }
  const bool repeat = rings.size() >= kMinFollowed && kMinOfFollowed * rings.size() <= order.size();
  return repeat ? followed : Followed{};
}

// The tolerance with the fewest ambiguous returns; of equal ones the widest.
template <typename Ring>
std::vector<int> FollowWithin(std::span<const UnsortedReturn> returns,
                              const std::vector<ConePlace>& places) {
  std::vector<double> keys;
  for (std::size_t i = 0; i < places.size(); ++i) keys.push_back(Ring::Key(places[i], returns[i]));
  std::vector<std::size_t> order(places.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, [&](std::size_t a, std::size_t b) {
    return keys[a] < keys[b] || (keys[a] == keys[b] && places[a].tangent < places[b].tangent);
  });
  Followed best;
  for (const double tolerance_deg : {0.8, 0.4, 0.2, 0.1, 0.05}) {
    Followed followed = Follow<Ring>(places, order, tolerance_deg * kRadPerDeg);
    if (followed.numbers.empty()) continue;
    if (best.numbers.empty() || followed.ambiguous < best.ambiguous) best = std::move(followed);
    if (static_cast<double>(best.ambiguous) < kClear * static_cast<double>(order.size())) break;
  }
  return best.numbers;
}

std::vector<std::vector<ConePlace>> ByRing(const std::vector<ConePlace>& places,
                                           const std::vector<int>& numbers) {
  std::vector<std::vector<ConePlace>> rings(1U +
                                            static_cast<std::size_t>(std::ranges::max(numbers)));
  for (std::size_t i = 0; i < places.size(); ++i) {
    rings[static_cast<std::size_t>(numbers[i])].push_back(places[i]);
  }
  return rings;
}

}  // namespace

std::vector<int> RingsByFollowing(std::span<const UnsortedReturn> returns) {
  std::vector<ConePlace> places;
  for (const UnsortedReturn& point : returns) places.push_back(ConePlace::Of(point));
  std::vector<int> numbers = FollowWithin<FarToNear>(returns, places);
  if (!numbers.empty() && AreNarrow(ByRing(places, numbers))) return numbers;
  return FollowWithin<AlongAzimuth>(returns, places);
}

}  // namespace sextant
