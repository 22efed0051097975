// SPDX-License-Identifier: Apache-2.0
#include "base/pair_by_stamp.h"

#include <algorithm>
#include <functional>
#include <queue>
#include <tuple>

namespace sextant {
namespace {

// A stamp in the merged order of both sets, with its nearest unpaired neighbours.
struct Stamp {
  std::int64_t time_ns = 0;
  bool is_second = false;
  std::size_t index = 0;
  std::size_t before = 0;
  std::size_t after = 0;
};

struct Candidate {
  std::int64_t distance_ns = 0;
  std::size_t left = 0;
  std::size_t right = 0;

  bool operator>(const Candidate& other) const {
    return std::tie(distance_ns, left) > std::tie(other.distance_ns, other.left);
  }
};

using Candidates = std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>>;

// The merged order between two sentinels, so that every stamp has neighbours.
std::vector<Stamp> Merged(std::span<const std::int64_t> first,
                          std::span<const std::int64_t> second) {
  std::vector<Stamp> stamps(1);
  for (std::size_t i = 0; i < first.size(); ++i) stamps.push_back({first[i], false, i});
  for (std::size_t i = 0; i < second.size(); ++i) stamps.push_back({second[i], true, i});
  std::sort(stamps.begin() + 1, stamps.end(), [](const Stamp& a, const Stamp& b) {
    return std::tie(a.time_ns, a.is_second, a.index) < std::tie(b.time_ns, b.is_second, b.index);
  });
  stamps.emplace_back();
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    stamps[i].before = i == 0 ? 0 : i - 1;
    stamps[i].after = std::min(i + 1, stamps.size() - 1);
  }
  return stamps;
}

}  // namespace

// The closest two unpaired stamps of different sets are neighbours in the merged order, because a
// stamp between them would be closer to one of them. Removing them makes new neighbours.
StampPairs PairByStamp(std::span<const std::int64_t> first, std::span<const std::int64_t> second,
                       std::int64_t tolerance_ns) {
  std::vector<Stamp> stamps = Merged(first, second);
  const std::size_t end = stamps.size() - 1;
  std::vector<bool> paired(stamps.size(), false);
  Candidates candidates;
  const auto consider = [&](std::size_t left, std::size_t right) {
    if (left == 0 || right == end || stamps[left].is_second == stamps[right].is_second) return;
    const std::int64_t distance = stamps[right].time_ns - stamps[left].time_ns;
    if (distance <= tolerance_ns) candidates.push({distance, left, right});
  };
  for (std::size_t i = 1; i < end; ++i) consider(i, i + 1);
  StampPairs found;
  while (!candidates.empty()) {
    const auto [distance, left, right] = candidates.top();
    candidates.pop();
    if (paired[left] || paired[right]) continue;
    paired[left] = true;
    paired[right] = true;
    const Stamp& a = stamps[left].is_second ? stamps[right] : stamps[left];
    const Stamp& b = stamps[left].is_second ? stamps[left] : stamps[right];
    found.pairs.push_back({a.index, b.index, b.time_ns - a.time_ns});
    const std::size_t before = stamps[left].before;
    const std::size_t after = stamps[right].after;
    stamps[before].after = after;
    stamps[after].before = before;
    consider(before, after);
  }
  std::sort(found.pairs.begin(), found.pairs.end(), [&](const StampPair& a, const StampPair& b) {
    return std::tie(first[a.first], a.first) < std::tie(first[b.first], b.first);
  });
  for (std::size_t i = 1; i < end; ++i) {
    if (paired[i]) continue;
    (stamps[i].is_second ? found.unpaired_second : found.unpaired_first).push_back(stamps[i].index);
  }
  return found;
}

}  // namespace sextant
