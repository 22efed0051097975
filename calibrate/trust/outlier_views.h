// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "solvers/joint/view_comparison.h"

namespace sextant {

/// The views, among those compared by their raw observations, that were left out or disagree with
/// the others beyond chance, each by its own sigma. The probability that any of n views in
/// accordance with the noise is marked is 1 percent (Bonferroni's bound). A view is as bad as its
/// worst board; one that was not compared is marked. O(views compared).
std::vector<bool> DisagreeingViews(std::span<const ViewComparison> compared,
                                   std::span<const int> views);

/// For views with pairs alone: those whose error is over twice the median and more than four scaled
/// median absolute deviations above it. None of fewer than four.
std::vector<bool> OutlyingViews(std::span<const double> errors);

}  // namespace sextant
