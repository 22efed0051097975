// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/outlier_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/median.h"

namespace sextant {
namespace {

constexpr double kFamilyLevel = 0.01;

// The probability that a standard normal variable exceeds `quantile`.
double TailProbability(double quantile) { return 0.5 * std::erfc(quantile / std::numbers::sqrt2); }

bool Disagrees(std::span<const ViewComparison> compared, int view, double level) {
  bool is_used = false;
  for (const ViewComparison& board : compared) {
    if (board.view != view || !board.used) continue;
    is_used = true;
    if (TailProbability(board.disagreement) < level) return true;
  }
  return !is_used;
}

}  // namespace

std::vector<bool> DisagreeingViews(std::span<const ViewComparison> compared,
                                   std::span<const int> views) {
  const auto count = static_cast<double>(std::max<std::size_t>(compared.size(), 1));
  std::vector<bool> disagreeing;
  disagreeing.reserve(views.size());
  for (const int view : views) {
    disagreeing.push_back(Disagrees(compared, view, kFamilyLevel / count));
  }
  return disagreeing;
}

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
