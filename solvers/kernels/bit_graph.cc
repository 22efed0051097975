// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/bit_graph.h"

#include "base/simd.h"

namespace sextant {
namespace {

SEXTANT_MULTIVERSION void CountNeighbours(const BitGraph& graph, int* degrees) {
  for (int v = 0; v < graph.vertices(); ++v) {
    degrees[v] = 0;
    for (std::size_t w = 0; w < graph.words(); ++w) degrees[v] += std::popcount(graph.Row(v)[w]);
  }
}

SEXTANT_MULTIVERSION int IntersectWords(const std::uint64_t* a, const std::uint64_t* b,
                                        std::size_t words, std::uint64_t* both) {
  int count = 0;
  for (std::size_t w = 0; w < words; ++w) {
    both[w] = a[w] & b[w];
    count += std::popcount(both[w]);
  }
  return count;
}

}  // namespace

BitGraph::BitGraph(int vertices)
    : vertices_(vertices),
      words_((static_cast<std::size_t>(vertices) + kWordBits - 1) / kWordBits),
      bits_(static_cast<std::size_t>(vertices) * words_, 0) {}

void BitGraph::Connect(int a, int b) {
  bits_[static_cast<std::size_t>(a) * words_ + WordOf(b)] |= BitOf(b);
  bits_[static_cast<std::size_t>(b) * words_ + WordOf(a)] |= BitOf(a);
}

bool BitGraph::AreConnected(int a, int b) const { return (Row(a)[WordOf(b)] & BitOf(b)) != 0; }

std::vector<int> DegreesOf(const BitGraph& graph) {
  std::vector<int> degrees(static_cast<std::size_t>(graph.vertices()));
  CountNeighbours(graph, degrees.data());
  return degrees;
}

int Intersect(const std::uint64_t* a, const std::uint64_t* b, std::size_t words,
              std::uint64_t* both) {
  return IntersectWords(a, b, words, both);
}

}  // namespace sextant
