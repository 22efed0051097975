// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "solvers/kernels/bit_graph.h"

namespace sextant {

struct Clique {
  std::vector<int> vertices;  ///< Ascending.
  bool is_maximum = true;     ///< False where the search stopped at max_nodes.
  std::int64_t nodes = 0;     ///< Number of nodes of the search tree.
};

/// A largest set of vertices that are all connected with each other.
///
/// A greedy clique gives a lower bound; vertices with too few neighbours for a larger clique are
/// removed, repeatedly, before the search. Exact branch and bound on the rest: the candidates of a
/// node are coloured greedily, and no clique has more vertices than colours (Tomita and Seki 2003;
/// bitsets as in San Segundo et al. 2011); vertices are in degeneracy order. After `max_nodes`
/// nodes, or as many as take that long where more than 1000 vertices are left, the largest clique
/// so far is returned. The same graph gives the same clique. Memory:
/// vertices^2 / 8 bytes for the graph, as much for what is left of it, and 1/8 of a kilobyte per
/// level for N = 1000.
Clique FindMaximumClique(const BitGraph& graph, std::int64_t max_nodes);

}  // namespace sextant
