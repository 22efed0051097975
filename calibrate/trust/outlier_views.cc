// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/outlier_views.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

double MedianOf(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  if (values.size() % 2 == 1) return *middle;
  return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

}  // namespace

std::vector<bool> OutlyingViews(std::span<const double> errors) {
  std::vector<bool> outlying(errors.size(), false);
  if (errors.size() < 4) return outlying;
  const double median = MedianOf({errors.begin(), errors.end()});
  std::vector<double> deviations;
  for (const double error : errors) deviations.push_back(std::abs(error - median));
  const double limit = std::max(2.0 * median, median + 4.0 * 1.4826 * MedianOf(deviations));
  for (std::size_t i = 0; i < errors.size(); ++i) outlying[i] = errors[i] > limit;
  return outlying;
}

}  // namespace sextant
