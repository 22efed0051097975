// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/outlying_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "base/median.h"
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

// Whether the inliers, which are of one kind, are known to be of this one.
bool HasInliersOf(const SolveReport& report, bool in_pixels) {
  if (ResidualsOf(report, !in_pixels).empty()) return true;
  if (!report.noise) return false;
  const bool is_m = report.noise->sigma_m.has_value();
  const bool is_px = report.noise->sigma_px.has_value();
  return in_pixels ? is_px && !is_m : is_m && !is_px;
}

// By the names in its spec: a report has no other trace of it where every pair was kept.
bool IsRobust(const std::string& spec) {
  constexpr std::array kRobust = {"ransac",     "gnc(",       "clique(",    "drop_worst(",
                                  "robust(",    "magsac",     "loss=huber", "loss=cauchy",
                                  "loss=tukey", "loss=barron"};
  return std::ranges::any_of(
      kRobust, [&](const char* name) { return spec.find(name) != std::string::npos; });
}

void AddOutliers(const SolveReport& report, bool in_pixels, std::span<const RepeatedPairs> repeated,
                 std::vector<std::string>& lines) {
  const std::vector<int> outliers = OutlyingPairs(report, in_pixels);
  if (outliers.empty()) return;
  const std::vector<double>& residuals = ResidualsOf(report, in_pixels);
  const auto is_used = [&](int i) {
    return std::binary_search(report.inliers.begin(), report.inliers.end(), i);
  };
  const bool are_used = !HasInliersOf(report, in_pixels) || std::ranges::any_of(outliers, is_used);
  const char* advice = !are_used ? "the answer leaves them out; check or remove them"
                       : IsRobust(report.solver) ? "check or remove them"
                                                 : "check or remove them, or use a robust solver";
  lines.push_back(fmt::format(
      "outliers: {} of {} pairs are farther off than the others' noise explains: {}; {}",
      outliers.size(), residuals.size(), OutlierList(residuals, outliers, in_pixels, repeated),
      advice));
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

// As TailOf, where the sigma has been estimated with `freedom` degrees of freedom: that of
// Student's distribution in two dimensions, and the same share more with three.
double TailOfEstimate(std::size_t count, int dimension, double freedom) {
  const double normal = TailOf(count, 2);
  const double tail = std::sqrt(freedom * std::expm1(normal * normal / freedom));
  return tail * TailOf(count, dimension) / normal;
}

// Outliers among the pairs that an answer leaves out. Even among true pairs those left out are the
// farthest, so they are tried one by one, the nearest first, and one that the noise of those before
// it explains counts for the noise from then on.
std::vector<int> OutlyingAmongLeftOut(std::span<const double> residuals,
                                      const std::vector<int>& inliers, int dimension) {
  constexpr double kUnknowns = 6.0;
  double squares = 0.0;
  double freedom = -kUnknowns;
  std::vector<int> left_out;
  for (int i = 0; i < static_cast<int>(residuals.size()); ++i) {
    const double residual = residuals[static_cast<std::size_t>(i)];
    if (std::binary_search(inliers.begin(), inliers.end(), i)) {
      squares += residual * residual;
      freedom += dimension;
    } else if (std::isfinite(residual)) {
      left_out.push_back(i);
    }
  }
  freedom = std::max(1.0, freedom);
  SortByResidual(residuals, left_out);
  while (!left_out.empty()) {
    const double residual = residuals[static_cast<std::size_t>(left_out.back())];
    // Few pairs determine their pose that much less well.
    const double variance = squares / freedom * (1.0 + kUnknowns / freedom);
    const double tail = TailOfEstimate(residuals.size(), dimension, freedom);
    if (residual * residual > tail * tail * variance) break;
    squares += residual * residual;
    freedom += dimension;
    left_out.pop_back();
  }
  return left_out;
}

}  // namespace

double SigmaByMedian(std::vector<double> residuals, int dimension) {
  std::erase_if(residuals, [](double residual) { return !std::isfinite(residual); });
  return UpperMedian(residuals) / (dimension == 3 ? 1.5382 : 1.1774);
}

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
  double sigma = SigmaByMedian(sorted, dimension);
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
  const bool leaves_out = !report.inliers.empty() && report.inliers.size() < residuals.size();
  if (!leaves_out || !HasInliersOf(report, in_pixels)) {
    return OutlyingResiduals(residuals, dimension);
  }
  return OutlyingAmongLeftOut(residuals, report.inliers, dimension);
}

std::vector<std::string> DescribeOutliers(const SolveReport& report,
                                          std::span<const RepeatedPairs> repeated) {
  std::vector<std::string> lines;
  AddOutliers(report, false, repeated, lines);
  AddOutliers(report, true, repeated, lines);
  return lines;
}

}  // namespace sextant
