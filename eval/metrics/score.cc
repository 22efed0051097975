// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/score.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

#include "base/median.h"

namespace sextant {
namespace {

constexpr double kMaxDeviations = 3.0;

using Residuals = std::vector<double> Evaluation::*;

// The smallest robust standard deviation of the residuals of one kind, but no less than `least`.
double SmallestSigma(const std::vector<ScoredRow>& rows, Residuals kind, double least) {
  constexpr double kSigmaOfMedian = 1.4826;
  double smallest = std::numeric_limits<double>::infinity();
  for (const ScoredRow& scored : rows) {
    if (!scored.row.report || !scored.spec.estimates_rotation) continue;
    std::vector<double> residuals = scored.row.report->evaluation.*kind;
    if (residuals.empty()) continue;
    smallest = std::min(smallest, kSigmaOfMedian * Median(residuals));
  }
  return std::max(least, smallest);
}

void AddSquares(const std::vector<double>& residuals, double sigma, double& sum,
                std::size_t& count) {
  for (const double residual : residuals) {
    const double deviations = std::min(kMaxDeviations, residual / sigma);
    sum += deviations * deviations;
  }
  count += residuals.size();
}

void SetScores(std::vector<ScoredRow>& rows) {
  // Of exact data, whose residuals are rounding errors.
  constexpr double kMinSigma_px = 1e-3;
  constexpr double kMinSigma_m = 1e-5;
  const double sigma_px = SmallestSigma(rows, &Evaluation::per_pair_px, kMinSigma_px);
  const double sigma_m = SmallestSigma(rows, &Evaluation::per_pair_m, kMinSigma_m);
  for (ScoredRow& scored : rows) {
    if (!scored.row.report) continue;
    double sum = 0.0;
    std::size_t count = 0;
    AddSquares(scored.row.report->evaluation.per_pair_px, sigma_px, sum, count);
    AddSquares(scored.row.report->evaluation.per_pair_m, sigma_m, sum, count);
    if (count > 0) scored.score = std::sqrt(sum / static_cast<double>(count));
  }
}

void MeasureFromFirst(std::vector<ScoredRow>& rows) {
  for (ScoredRow& scored : rows) {
    if (!scored.row.report) continue;
    scored.row.from_first =
        DistanceBetween(scored.row.report->cam_from_lidar, rows.front().row.report->cam_from_lidar);
  }
}

}  // namespace

std::vector<ScoredRow> SortByScore(std::vector<ComparisonRow> rows,
                                   std::span<const SolverSpec> specs) {
  std::vector<ScoredRow> scored;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    scored.push_back({.row = std::move(rows[i]), .spec = specs[i]});
  }
  SetScores(scored);
  std::ranges::stable_sort(scored, {}, [](const ScoredRow& of) {
    constexpr double kNone = std::numeric_limits<double>::infinity();
    return std::tuple(!of.row.report.has_value(), !of.spec.estimates_rotation,
                      of.score.value_or(kNone));
  });
  MeasureFromFirst(scored);
  return scored;
}

}  // namespace sextant
