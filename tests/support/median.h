// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/median.h"

namespace sextant::test {

/// UpperMedian of a copy. Requires values.
inline double Median(std::vector<double> values) { return UpperMedian(values); }

}  // namespace sextant::test
