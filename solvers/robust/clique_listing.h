// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/kernels/bit_graph.h"

namespace sextant {

/// Every clique of at least `least` vertices, each ascending, in lexical order; the first `most` of
/// them. Bounded by counting candidates, so quick where few vertices have `least` neighbours in
/// common; ends after `max_nodes` nodes.
std::vector<std::vector<int>> ListCliques(const BitGraph& graph, std::size_t least,
                                          std::size_t most, std::int64_t max_nodes);

}  // namespace sextant
