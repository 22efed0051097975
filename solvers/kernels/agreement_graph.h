// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "solvers/kernels/bit_graph.h"
#include "solvers/kernels/pair_columns.h"

namespace sextant {

/// Whether the lengths from i to j in both frames differ by at most
/// sqrt(max_squared (variance_i + variance_j)), as those of two true pairs do.
bool Agree(const PairColumns& pairs, std::size_t i, std::size_t j, double max_squared);

/// The graph in which pairs are connected where they agree. Half of the comparisons are computed,
/// the rest is mirrored.
BitGraph AgreementGraph(const PairColumns& pairs, double max_squared);

/// The row of pair i in that graph. Shape: one bit per pair, rounded up to words.
void RowOfAgreements(const PairColumns& pairs, std::size_t i, double max_squared,
                     std::span<std::uint64_t> row);

}  // namespace sextant
