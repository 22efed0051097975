// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace sextant {

/// The probability that a random point in `box`, grown by `radius`, is within it of another point.
inline double RandomPointProbability(const Eigen::AlignedBox3d& box, double radius) {
  const double ball = 4.0 / 3.0 * std::numbers::pi * radius * radius * radius;
  return std::min(1.0, ball / (box.sizes().array() + 2.0 * radius).prod());
}

/// The two measurements of a pair.
using PairNumbers = std::array<double, 6>;

/// The number of different pairs at `indices`; numbers_of(i) gives the PairNumbers of pair i. Pairs
/// are compared by a hash of 64 bits, which is the same for different pairs by a negligible chance.
template <class NumbersOf>
int CountDistinctPairs(std::span<const int> indices, const NumbersOf& numbers_of) {
  // Open addressing in a table that is at most half full; 0 marks a free place.
  std::vector<std::uint64_t> table(std::bit_ceil(2 * indices.size() + 1), 0);
  int distinct = 0;
  for (const int i : indices) {
    std::uint64_t hash = 0;
    for (const double number : numbers_of(static_cast<std::size_t>(i))) {
      // Adding zero makes -0 and 0 equal.
      hash = (hash ^ std::bit_cast<std::uint64_t>(number + 0.0)) * 0x9E3779B97F4A7C15ULL;
      hash ^= hash >> 29;
    }
    hash = std::max<std::uint64_t>(hash, 1);
    std::size_t place = hash & (table.size() - 1);
    while (table[place] != 0 && table[place] != hash) place = (place + 1) & (table.size() - 1);
    if (table[place] == 0) ++distinct;
    table[place] = hash;
  }
  return distinct;
}

}  // namespace sextant
