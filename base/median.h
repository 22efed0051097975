// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

namespace sextant {

/// The median of an odd number of values, the upper of the two middle ones of an even number; 0 of
/// none. Reorders the values: no value before place size / 2 is above the result, none after below.
inline double UpperMedian(std::span<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// As UpperMedian, but the mean of the two middle values of an even number.
inline double Median(std::span<double> values) {
  const double upper = UpperMedian(values);
  if (values.empty() || values.size() % 2 == 1) return upper;
  return 0.5 * (upper + std::ranges::max(values.first(values.size() / 2)));
}

}  // namespace sextant
