// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "eval/metrics/compare.h"

namespace sextant {

/// A row of a comparison with what it is worth.
struct ScoredRow {
  ComparisonRow row;
  SolverSpec spec = {};
  std::optional<double> score = {};  ///< None without an answer or without pairs.
};

/// The rows, best first, by a score that holds every answer to all pairs, whichever of them it
/// used: the root of the mean of min(r / s, 3)^2 over the residuals r of all pairs, s the smallest
/// over the answers of the standard deviation that the smaller half of their residuals of that kind
/// shows, as the smaller half of normal ones, and then all within five of it.
/// A pair that does not project counts as 3. Of equal scores, as where no residual is below 3, the
/// smaller RMSE over all pairs comes first; rows without an answer come last. from_first then is
/// the distance to the best answer. `specs`: one for each row.
std::vector<ScoredRow> SortByScore(std::vector<ComparisonRow> rows,
                                   std::span<const SolverSpec> specs);

}  // namespace sextant
