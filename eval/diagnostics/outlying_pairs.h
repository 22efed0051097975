// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "eval/diagnostics/repeated_pairs.h"
#include "solvers/core/solver.h"

namespace sextant {

/// The noise of a coordinate by the median of the residuals, which a few wrong pairs do not change;
/// 0 without a finite one. `dimension`: 3 for points, 2 for pixels. O(n).
double SigmaByMedian(std::vector<double> residuals, int dimension);

/// Indices of the residuals [m or px] that noise does not explain, largest first: beyond the limit
/// that one of all pairs exceeds with a probability of 1 %, where the noise is that of the
/// others (at first the median's), and at least a tenth of the largest, because an outlier moves
/// the answer and with it the residuals of the others. Residuals that are not finite do not count.
/// Empty below eight pairs. `dimension`: 3 for points, 2 for pixels. O(n log n).
std::vector<int> OutlyingResiduals(std::span<const double> residuals, int dimension);

/// The same for the pairs of an answer. Where it leaves pairs of this kind out, these are the pairs
/// left out that the residuals of the others do not explain, of which there may be less than half,
/// however few pairs there are: from the nearest on, until one is beyond the limit that one of all
/// true pairs exceeds with a probability of 1 %.
std::vector<int> OutlyingPairs(const SolveReport& report, bool in_pixels);

/// One sentence for each kind of pairs with outliers, by their place in the file,
/// from which `repeated` pairs have been removed. A robust solver is advised only where the answer
/// is of another one.
std::vector<std::string> DescribeOutliers(const SolveReport& report,
                                          std::span<const RepeatedPairs> repeated);

}  // namespace sextant
