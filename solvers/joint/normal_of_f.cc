// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/normal_of_f.h"

#include <cmath>

namespace sextant {

double NormalOfF(double quotient, double freedom, double freedom_of_scale) {
  const double root = std::cbrt(quotient);
  const double a = 2.0 / (9.0 * freedom);
  const double b = 2.0 / (9.0 * freedom_of_scale);
  return ((1.0 - b) * root - (1.0 - a)) / std::sqrt(a + b * root * root);
}

}  // namespace sextant
