// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/score.h"

#include <algorithm>
#include <boost/math/special_functions/gamma.hpp>
#include <cmath>
#include <limits>
#include <tuple>
#include <utility>

namespace sextant {
namespace {

constexpr double kMaxDeviations = 3.0;

using Residuals = std::vector<double> Evaluation::*;

// The mean square of the smallest `share` of residuals with `dimension` normal numbers each, over
// that of all: chi-square cut off at its quantile.
double ShareOfSquares(double share, double dimension) {
  if (!(share < 1.0)) return 1.0;
  const double cut = boost::math::gamma_p_inv(0.5 * dimension, share);
  return boost::math::gamma_p(0.5 * dimension + 1.0, cut) / share;
}

// From the smaller half of the residuals and two more, of `dimension` numbers each, as if all were
// normal, and then from all within five of it, less the six unknowns of a pose: an answer that
// fits three pairs exactly does not look exact, and one whose smaller half happens to be small does
// not look better than it is.
double RobustSigma(std::vector<double> residuals, double dimension) {
  std::ranges::sort(residuals);
  const std::size_t half = std::max<std::size_t>(3, (residuals.size() + 1) / 2);
  const std::size_t count = std::min(residuals.size(), half + 2);
  double sum = 0.0;
  for (std::size_t i = 0; i < count; ++i) sum += residuals[i] * residuals[i];
  const double share = static_cast<double>(count) / static_cast<double>(residuals.size());
  const double variance = sum / std::max(1.0, dimension * static_cast<double>(count) - 6.0);
  double sigma = std::sqrt(variance / ShareOfSquares(share, dimension));
  // The smaller half of one of many answers is small by chance, and three times that may leave out
  // true pairs for good.
  constexpr int kMaxRounds = 5;
  constexpr double kFarOut = 5.0;
  for (int round = 0; round < kMaxRounds; ++round) {
    double within = 0.0;
    double freedom = -6.0;
    for (const double residual : residuals) {
      if (residual > kFarOut * sigma) break;
      within += residual * residual;
      freedom += dimension;
    }
    sigma = std::max(sigma, std::sqrt(within / std::max(1.0, freedom)));
  }
  return sigma;
}

// The smallest over the answers, but no less than `least`.
double SmallestSigma(const std::vector<ScoredRow>& rows, Residuals kind, double dimension,
                     double least) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const ScoredRow& scored : rows) {
    if (!scored.row.report || !scored.spec.estimates_rotation) continue;
    const std::vector<double>& residuals = scored.row.report->evaluation.*kind;
    if (!residuals.empty()) smallest = std::min(smallest, RobustSigma(residuals, dimension));
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
  // The residuals of exact data are rounding errors.
  constexpr double kMinSigma_px = 1e-3;
  constexpr double kMinSigma_m = 1e-5;
  const double sigma_px = SmallestSigma(rows, &Evaluation::per_pair_px, 2.0, kMinSigma_px);
  const double sigma_m = SmallestSigma(rows, &Evaluation::per_pair_m, 3.0, kMinSigma_m);
  for (ScoredRow& scored : rows) {
    if (!scored.row.report) continue;
    double sum = 0.0;
    std::size_t count = 0;
    AddSquares(scored.row.report->evaluation.per_pair_px, sigma_px, sum, count);
    AddSquares(scored.row.report->evaluation.per_pair_m, sigma_m, sum, count);
    if (count > 0) scored.score = std::sqrt(sum / static_cast<double>(count));
  }
}

// All answers for which no pair is within kMaxDeviations have the same score.
double RmsOfAll(const ScoredRow& scored) {
  if (!scored.row.report) return 0.0;
  const Evaluation& evaluation = scored.row.report->evaluation;
  return evaluation.rmse_px.value_or(evaluation.rmse_m.value_or(0.0));
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
    constexpr double kWorst = std::numeric_limits<double>::infinity();
    return std::tuple(!of.row.report.has_value(), of.score.value_or(kWorst), RmsOfAll(of));
  });
  MeasureFromFirst(scored);
  return scored;
}

}  // namespace sextant
