// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/diagnostics/repeated_pairs.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Indices of the residuals [m or px] that noise does not explain, largest first: beyond the limit
/// that one of all pairs exceeds with a probability of 1 %, where the noise is that of the
/// others (at first the median's), and at least a tenth of the largest, because an outlier moves
/// the answer and with it the residuals of the others. Residuals that are not finite do not count.
/// Empty below eight pairs. `dimension`: 3 for points, 2 for pixels. O(n log n).
std::vector<int> OutlyingResiduals(std::span<const double> residuals, int dimension);

/// The same for the pairs of an answer. Where it leaves pairs out and has estimated the noise of
/// the others, which may be less than half of all, these are the pairs left out that this noise
/// does not explain, however few pairs there are.
std::vector<int> OutlyingPairs(const SolveReport& report, bool in_pixels);

/// One sentence for each kind of pairs with outliers, by their place in the file,
/// from which `repeated` pairs have been removed.
std::vector<std::string> DescribeOutliers(const SolveReport& report,
                                          std::span<const RepeatedPairs> repeated);

}  // namespace sextant
