// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "solvers/kernels/bit_graph.h"

namespace sextant {

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
