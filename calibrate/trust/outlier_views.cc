// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/outlier_views.h"

#include <algorithm>
#include <cmath>

#include "base/median.h"

namespace sextant {

std::vector<bool> OutlyingViews(std::span<const double> errors) {
  std::vector<bool> outlying(errors.size(), false);
  if (errors.size() < 4) return outlying;
  std::vector<double> ordered(errors.begin(), errors.end());
  const double median = Median(ordered);
  std::vector<double> deviations;
  for (const double error : errors) deviations.push_back(std::abs(error - median));
  const double limit = std::max(2.0 * median, median + 4.0 * 1.4826 * Median(deviations));
  for (std::size_t i = 0; i < errors.size(); ++i) outlying[i] = errors[i] > limit;
  return outlying;
}

}  // namespace sextant
