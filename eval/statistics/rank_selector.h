// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace sextant {

/// Order statistics of numbers that pass by kPasses times, of which none is kept: each pass counts
/// those that share the leading bits of a wanted one, and so settles eight bits more of it. Exact,
/// in memory that depends on how many ranks are wanted alone.
class RankSelector {
 public:
  static constexpr int kPasses = 8;

  /// `ranks` count from 0, the least, in any order; each must be below the number of values.
  explicit RankSelector(std::vector<std::uint64_t> ranks);

  /// Requires a number. All values of a pass, then EndPass(); the same values in each.
  void Add(double value);
  void EndPass();

  /// Requires kPasses, and one of the ranks.
  double ValueAt(std::uint64_t rank) const;

 private:
  using Counts = std::array<std::uint64_t, 256>;
  struct Sought {
    std::uint64_t rank = 0;
    std::uint64_t prefix = 0;  // Its leading bits, as far as they are known.
    std::uint64_t within = 0;  // Its rank among those with the same.
  };

  std::vector<Sought> sought_;           // By rank.
  std::vector<std::uint64_t> prefixes_;  // Ascending, each once.
  std::vector<Counts> counts_;           // Of the next eight bits, by prefix.
  int pass_ = 0;
};

}  // namespace sextant
