// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>
#include <vector>

namespace sextant {

/// The probability that a random point in a box is within a distance of another one: that of being
/// in a cube (or square) as large as the ball (or disc), which is 1 where that is wider than the
/// box.
template <int kSize>
double RandomPointProbability(const Eigen::AlignedBox<double, kSize>& box, double radius) {
  static_assert(kSize == 2 || kSize == 3);
  const double width =
      radius * (kSize == 2 ? std::sqrt(std::numbers::pi) : std::cbrt(4.0 / 3.0 * std::numbers::pi));
  double probability = 1.0;
  for (const double side : box.sizes()) probability *= width < side ? width / side : 1.0;
  return probability;
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
