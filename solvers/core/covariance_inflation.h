// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace sextant {

/// By what to multiply the covariance of a pose, of which the variance of the noise was estimated
/// with so many degrees of freedom, so that the 95 percent region of a Gaussian is that of the
/// answer: 6 F(6, freedom) / chi2(6), quantiles at 0.95, to 9 percent from 2 degrees of freedom and
/// to 5 percent from 4 on.
inline double CovarianceInflation(double freedom) {
  constexpr double kLeast = 2.0;
  const double f = std::max(kLeast, freedom);
  return (f + 3.0) / (f - 1.5);
}

}  // namespace sextant
