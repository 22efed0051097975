// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>

namespace sextant {

/// log of (n over k), as a sum: std::lgamma writes a global variable, which is a data race. Time
/// O(min(k, n - k)).
inline double LogChoose(int n, int k) {
  constexpr double kLarge = 1e290;
  const int smaller = std::min(k, n - k);
  double sum = 0.0;
  double product = 1.0;
  for (int i = 1; i <= smaller; ++i) {
    product *= static_cast<double>(n - smaller + i) / i;
    if (product < kLarge) continue;
    sum += std::log(product);
    product = 1.0;
  }
  return sum + std::log(product);
}

}  // namespace sextant
