// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace sextant {

/// An undirected graph without loops, as a matrix of bits.
class BitGraph {
 public:
  explicit BitGraph(int vertices);

  int vertices() const { return vertices_; }
  void Connect(int a, int b);
  bool AreConnected(int a, int b) const;

  /// The row of `vertex`: bit j of the row is set where j is a neighbour. `words()` words.
  const std::uint64_t* Row(int vertex) const {
    return bits_.data() + static_cast<std::size_t>(vertex) * words_;
  }
  std::uint64_t* Row(int vertex) {
    return bits_.data() + static_cast<std::size_t>(vertex) * words_;
  }
  std::size_t words() const { return words_; }

 private:
  int vertices_;
  std::size_t words_;
  std::vector<std::uint64_t> bits_;
};

/// The word and bit of a vertex in a row.
inline constexpr int kWordBits = 64;
inline std::size_t WordOf(int vertex) { return static_cast<std::size_t>(vertex) / kWordBits; }
inline std::uint64_t BitOf(int vertex) { return std::uint64_t{1} << (vertex % kWordBits); }

/// Writes a & b and returns the number of its bits.
int Intersect(const std::uint64_t* a, const std::uint64_t* b, std::size_t words,
              std::uint64_t* both);

/// The number of neighbours of every vertex.
std::vector<int> DegreesOf(const BitGraph& graph);

/// Calls visit(vertex) for every bit that is set, ascending.
template <class Visit>
void ForEachBit(const std::uint64_t* bits, std::size_t words, Visit&& visit) {
  for (std::size_t w = 0; w < words; ++w) {
    for (std::uint64_t left = bits[w]; left != 0; left &= left - 1) {
      visit(static_cast<int>(w) * kWordBits + std::countr_zero(left));
    }
  }
}

}  // namespace sextant
