// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/rank_selector.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace sextant {
namespace {

constexpr std::uint64_t kSign = std::uint64_t{1} << 63U;

// Maps doubles to unsigned integers of the same order; -0.0 and 0.0 get the same key.
std::uint64_t KeyOf(double value) {
  const auto bits = std::bit_cast<std::uint64_t>(value + 0.0);
  return (bits & kSign) != 0 ? ~bits : bits | kSign;
}

double ValueOf(std::uint64_t key) {
  return std::bit_cast<double>((key & kSign) != 0 ? key & ~kSign : ~key);
}

}  // namespace

RankSelector::RankSelector(std::vector<std::uint64_t> ranks) : prefixes_(1, 0), counts_(1) {
  std::sort(ranks.begin(), ranks.end());
  ranks.erase(std::unique(ranks.begin(), ranks.end()), ranks.end());
  for (const std::uint64_t rank : ranks) sought_.push_back({rank, 0, rank});
}

void RankSelector::Add(double value) {
  assert(!std::isnan(value) && pass_ < kPasses);
  const std::uint64_t key = KeyOf(value);
  const int unknown_bits = 64 - 8 * pass_;
  const std::uint64_t prefix = pass_ == 0 ? 0 : key >> unknown_bits;
  const auto place = std::lower_bound(prefixes_.begin(), prefixes_.end(), prefix);
  if (place == prefixes_.end() || *place != prefix) return;
  ++counts_[static_cast<std::size_t>(place - prefixes_.begin())][key >> (unknown_bits - 8) & 0xffU];
}

void RankSelector::EndPass() {
  std::vector<std::uint64_t> prefixes;
  for (Sought& sought : sought_) {
    const auto place = std::lower_bound(prefixes_.begin(), prefixes_.end(), sought.prefix);
    const Counts& counts = counts_[static_cast<std::size_t>(place - prefixes_.begin())];
    std::uint64_t next = 0;
    while (next < 255 && sought.within >= counts[next]) sought.within -= counts[next++];
    sought.prefix = sought.prefix << 8U | next;
    if (prefixes.empty() || prefixes.back() != sought.prefix) prefixes.push_back(sought.prefix);
  }
  prefixes_ = std::move(prefixes);
  counts_.assign(prefixes_.size(), Counts{});
  ++pass_;
}

double RankSelector::ValueAt(std::uint64_t rank) const {
  assert(pass_ == kPasses);
  const auto found =
      std::lower_bound(sought_.begin(), sought_.end(), rank,
                       [](const Sought& sought, std::uint64_t r) { return sought.rank < r; });
  assert(found != sought_.end() && found->rank == rank);
  return ValueOf(found->prefix);
}

}  // namespace sextant
