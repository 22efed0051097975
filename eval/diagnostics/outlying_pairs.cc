// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/outlying_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/units.h"

namespace sextant {
namespace {

// The place in the file of a pair that is left after the merge.
int PlaceInFile(int index, bool in_pixels, std::span<const RepeatedPairs> repeated) {
  for (const RepeatedPairs& of_kind : repeated) {
    if (of_kind.in_pixels != in_pixels) continue;
    for (const RepeatedPair& pair : of_kind.merged) {
      if (pair.repeat <= index) ++index;
    }
  }
  return index + 1;
}

std::string OutlierList(std::span<const double> residuals, const std::vector<int>& outliers,
                        bool in_pixels, std::span<const RepeatedPairs> repeated) {
  constexpr std::size_t kMaxListed = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(outliers.size(), kMaxListed); ++i) {
    const double residual = residuals[static_cast<std::size_t>(outliers[i])];
    text += fmt::format("{}pair {} ({:.3g} {})", i == 0 ? "" : ", ",
                        PlaceInFile(outliers[i], in_pixels, repeated),
                        in_pixels ? residual : residual * kMmPerM, in_pixels ? "px" : "mm");
  }
  return outliers.size() > kMaxListed ? text + ", ..." : text;
}

void AddOutliers(std::span<const double> residuals, bool in_pixels,
                 std::span<const RepeatedPairs> repeated, std::vector<std::string>& lines) {
  const std::vector<int> outliers = OutlyingResiduals(residuals, in_pixels ? 2 : 3);
  if (outliers.empty()) return;
  lines.push_back(fmt::format(
      "outliers: {} of {} pairs are farther off than the others' noise explains: {}; check or "
      "remove them, or use a robust solver",
      outliers.size(), residuals.size(), OutlierList(residuals, outliers, in_pixels, repeated)));
}

// The noise of a coordinate, from the residuals up to a limit about a pose of six parameters.
double SigmaOfThoseUpTo(double limit, const std::vector<double>& sorted, int dimension) {
  double squares = 0.0;
  double freedom = -6.0;
  for (const double residual : sorted) {
    if (residual > limit) break;
    squares += residual * residual;
    freedom += dimension;
  }
  return std::sqrt(squares / std::max(1.0, freedom));
}

}  // namespace

std::vector<int> OutlyingResiduals(std::span<const double> residuals, int dimension) {
  constexpr std::size_t kMinPairs = 8;
  constexpr double kChance = 0.01;
  constexpr double kOfLargest = 0.1;
  constexpr int kMaxRounds = 5;
  std::vector<double> sorted;
  for (const double residual : residuals) {
    if (std::isfinite(residual)) sorted.push_back(residual);
  }
  if (sorted.size() < kMinPairs) return {};
  std::ranges::sort(sorted);
  // The tail of the chi distribution with 3 degrees lies 0.5 farther out than that with 2.
  const double tail = std::sqrt(2.0 * std::log(static_cast<double>(sorted.size()) / kChance)) +
                      (dimension == 3 ? 0.5 : 0.0);
  double sigma = sorted[sorted.size() / 2] / (dimension == 3 ? 1.5382 : 1.1774);
  double limit = 0.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    limit = std::max(tail * sigma, kOfLargest * sorted.back());
    sigma = SigmaOfThoseUpTo(limit, sorted, dimension);
  }
  std::vector<int> outliers;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    if (std::isfinite(residuals[i]) && residuals[i] > limit) {
      outliers.push_back(static_cast<int>(i));
    }
  }
  std::ranges::stable_sort(outliers, std::ranges::greater{},
                           [&](int i) { return residuals[static_cast<std::size_t>(i)]; });
  return outliers;
}

std::vector<std::string> DescribeOutliers(const Evaluation& evaluation,
                                          std::span<const RepeatedPairs> repeated) {
  std::vector<std::string> lines;
  AddOutliers(evaluation.per_pair_m, false, repeated, lines);
  AddOutliers(evaluation.per_pair_px, true, repeated, lines);
  return lines;
}

}  // namespace sextant
