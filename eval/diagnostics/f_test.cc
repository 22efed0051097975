// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/f_test.h"

#include <boost/math/special_functions/beta.hpp>
#include <cmath>

namespace sextant {

double TailOfF(double f, double d1, double d2) {
  return boost::math::ibeta(0.5 * d2, std::ceil(0.5 * d1), d2 / (d2 + d1 * f));
}

}  // namespace sextant
