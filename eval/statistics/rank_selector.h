// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sextant {

/// Exact order statistics of values that are presented kPasses times and not stored. Each pass
/// counts the values that share the known leading bits of a wanted one and so determines eight more
/// of its bits (radix selection). Memory depends only on the number of wanted ranks.
class RankSelector {
 public:
  static constexpr int kPasses = 8;

  /// `ranks` count from 0 (the minimum), in any order; each must be below the number of values.
  explicit RankSelector(std::vector<std::uint64_t> ranks);

  /// `value` must not be NaN. Add all values, then call EndPass(); every pass gets the same values.
  void Add(double value);
  void EndPass();

  /// Requires kPasses completed passes and one of the ranks.
  double ValueAt(std::uint64_t rank) const;

 private:
  using Counts = std::array<std::uint64_t, 256>;
  struct Sought {
    std::uint64_t rank = 0;
    std::uint64_t prefix = 0;  // The leading bits that are known so far.
    std::uint64_t within = 0;  // The rank among the values with this prefix.
  };

  std::vector<Sought> sought_;           // Ordered by rank.
  std::vector<std::uint64_t> prefixes_;  // Ascending and distinct.
  std::vector<Counts> counts_;           // Histogram of the next eight bits, for each prefix.
  int pass_ = 0;
};

}  // namespace sextant
