// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

namespace sextant {

/// Which of the views' errors are over twice the median and over four scaled median absolute
/// deviations (1.4826) beyond it; none of fewer than four, which have no majority to speak of.
std::vector<bool> OutlyingViews(std::span<const double> errors);

}  // namespace sextant
