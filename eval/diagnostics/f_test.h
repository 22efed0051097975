// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace sextant {

/// The probability that F with `d1` and `d2` degrees of freedom exceeds `f` by chance. Exact for an
/// even d1 (otherwise that of the next larger one); a finite sum of the incomplete beta function.
inline double TailOfF(double f, double d1, double d2) {
  const double x = d2 / (d2 + d1 * f);
  const double a = 0.5 * d2;
  double term = std::pow(x, a);
  double sum = 0.0;
  for (double i = 0.0; i < std::ceil(0.5 * d1); i += 1.0) {
    sum += term;
    term *= (a + i) / (i + 1.0) * (1.0 - x);
  }
  return sum;
}

}  // namespace sextant
