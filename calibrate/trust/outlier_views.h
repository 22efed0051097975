// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace sextant {

/// Marks errors that are over twice the median and more than four scaled median absolute deviations
/// (1.4826) above it. Fewer than four views have no clear majority, so none of them is marked.
std::vector<bool> OutlyingViews(std::span<const double> errors);

}  // namespace sextant
