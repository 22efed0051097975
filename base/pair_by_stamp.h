// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sextant {

struct StampPair {
  std::size_t first = 0;
  std::size_t second = 0;
  std::int64_t difference_ns = 0;  ///< Second minus first.
};

struct StampPairs {
  std::vector<StampPair> pairs{};  ///< By ascending stamp of the first.
  std::vector<std::size_t> unpaired_first{};
  std::vector<std::size_t> unpaired_second{};
};

/// Pairs two sets of stamps [ns], in any order, greedily: repeatedly takes the closest pair of
/// those that remain, until none is within the tolerance. Each stamp is used at most once; of two
/// equally close pairs the earlier is taken. O(n log n).
StampPairs PairByStamp(std::span<const std::int64_t> first, std::span<const std::int64_t> second,
                       std::int64_t tolerance_ns);

}  // namespace sextant
