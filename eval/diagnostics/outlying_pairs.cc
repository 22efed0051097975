// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/outlying_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "base/units.h"

namespace sextant {
namespace {

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

const std::vector<double>& ResidualsOf(const SolveReport& report, bool in_pixels) {
  return in_pixels ? report.evaluation.per_pair_px : report.evaluation.per_pair_m;
}

void AddOutliers(const SolveReport& report, bool in_pixels, std::span<const RepeatedPairs> repeated,
                 std::vector<std::string>& lines) {
  const std::vector<int> outliers = OutlyingPairs(report, in_pixels);
  if (outliers.empty()) return;
  const std::vector<double>& residuals = ResidualsOf(report, in_pixels);
  const bool are_used = std::any_of(outliers.begin(), outliers.end(), [&](int i) {
    return std::binary_search(report.inliers.begin(), report.inliers.end(), i);
  });
  lines.push_back(fmt::format(
      "outliers: {} of {} pairs are farther off than the others' noise explains: {}; {}",
      outliers.size(), residuals.size(), OutlierList(residuals, outliers, in_pixels, repeated),
      are_used ? "check or remove them, or use a robust solver"
               : "the answer leaves them out; check or remove them"));
}

// The residual in sigmas that one of `count` pairs exceeds with a probability of 1 %. The tail of
// the chi distribution with 3 degrees lies 0.5 farther out than that with 2.
double TailOf(std::size_t count, int dimension) {
  constexpr double kChance = 0.01;
  return std::sqrt(2.0 * std::log(static_cast<double>(count) / kChance)) +
         (dimension == 3 ? 0.5 : 0.0);
}

// Largest first.
void SortByResidual(std::span<const double> residuals, std::vector<int>& indices) {
  std::ranges::stable_sort(indices, std::ranges::greater{},
                           [&](int i) { return residuals[static_cast<std::size_t>(i)]; });
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
  constexpr double kOfLargest = 0.1;
  constexpr int kMaxRounds = 5;
  std::vector<double> sorted;
  for (const double residual : residuals) {
    if (std::isfinite(residual)) sorted.push_back(residual);
  }
  if (sorted.size() < kMinPairs) return {};
  std::ranges::sort(sorted);
  const double tail = TailOf(sorted.size(), dimension);
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
  SortByResidual(residuals, outliers);
  return outliers;
}

std::vector<int> OutlyingPairs(const SolveReport& report, bool in_pixels) {
  const std::vector<double>& residuals = ResidualsOf(report, in_pixels);
  const int dimension = in_pixels ? 2 : 3;
  double sigma = 0.0;  // Not estimated.
  if (report.noise) {
    sigma = (in_pixels ? report.noise->sigma_px : report.noise->sigma_m).value_or(0.0);
  }
  // The inliers are of one kind only.
  const bool one_kind =
      report.evaluation.per_pair_m.empty() || report.evaluation.per_pair_px.empty();
  const bool leaves_out = !report.inliers.empty() && report.inliers.size() < residuals.size();
  if (sigma == 0.0 || !one_kind || !leaves_out) return OutlyingResiduals(residuals, dimension);
  // Few pairs determine their pose and noise that much less well.
  const double freedom =
      std::max(1.0, dimension * static_cast<double>(report.inliers.size()) - 6.0);
  const double limit = TailOf(residuals.size(), dimension) * sigma * (1.0 + 6.0 / freedom);
  std::vector<int> outliers;
  for (int i = 0; i < static_cast<int>(residuals.size()); ++i) {
    const double residual = residuals[static_cast<std::size_t>(i)];
    const bool is_used = std::binary_search(report.inliers.begin(), report.inliers.end(), i);
    if (!is_used && std::isfinite(residual) && residual > limit) outliers.push_back(i);
  }
  SortByResidual(residuals, outliers);
  return outliers;
}

std::vector<std::string> DescribeOutliers(const SolveReport& report,
                                          std::span<const RepeatedPairs> repeated) {
  std::vector<std::string> lines;
  AddOutliers(report, false, repeated, lines);
  AddOutliers(report, true, repeated, lines);
  return lines;
}

}  // namespace sextant
