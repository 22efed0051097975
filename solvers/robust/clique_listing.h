// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/kernels/bit_graph.h"

namespace sextant {

/// The first `max_cliques` cliques of at least `min_size` vertices, in lexical order, each with its
/// vertices ascending. Branches with too few candidates are cut, so the search is quick where few
/// vertices have `min_size` neighbours in common; it ends after `max_nodes` nodes.
std::vector<std::vector<int>> ListCliques(const BitGraph& graph, std::size_t min_size,
                                          std::size_t max_cliques, std::int64_t max_nodes);

}  // namespace sextant
