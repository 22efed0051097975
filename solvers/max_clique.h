// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace sextant {

/// An undirected graph without loops, as a matrix of bits.
class BitGraph {
 public:
  explicit BitGraph(int vertices);

  int vertices() const { return vertices_; }
  void Connect(int a, int b);
  /// Removes every edge of `vertex`.
  void Isolate(int vertex);
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

struct Clique {
  std::vector<int> vertices;  ///< Ascending.
  bool is_maximum = true;     ///< False where the search stopped at its limit.
  std::int64_t nodes = 0;     ///< Of the search tree.
};

/// A largest set of vertices that are all connected with each other.
///
/// A clique found greedily bounds the answer from below; vertices with too few neighbours for a
/// larger one go, and those that then have too few, before the search. Exact branch and bound on
/// the rest: a node's candidates are coloured greedily, no clique has more vertices than colours
/// (Tomita and Seki 2003; bitsets as in San Segundo et al. 2011), vertices in degeneracy order.
/// After `max_nodes` nodes the largest clique so far. The same graph gives the same clique.
/// Memory: vertices^2 / 8 bytes for the graph, as much for what is left of it, 1/8 of a kilobyte a
/// level for N = 1000.
Clique FindMaximumClique(const BitGraph& graph, std::int64_t max_nodes);

}  // namespace sextant
