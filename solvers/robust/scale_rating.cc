// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/scale_rating.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace sextant {
namespace {

// Share of the extent of the measurements: noise below this is rounding.
constexpr double kMinShare = 1e-7;
// No measurement is finer than this share of the extent: a few pairs that agree even better,
// because one was computed from the other, are no stronger evidence than many that agree as well as
// measurements do.
constexpr double kFinestShare = 1e-4;
// Exponent and the two leading bits of the mantissa: four bins per factor of two.
constexpr int kBinShift = 50;

std::int64_t LeadingBits(double positive) {
  return static_cast<std::int64_t>(std::bit_cast<std::uint64_t>(positive) >> kBinShift);
}

// log Gamma(z) for z > 0 by Stirling's series: std::lgamma writes a global variable, which is a
// data race.
double LogGamma(double z) {
  double shift = 0.0;
  for (; z < 8.0; z += 1.0) shift += std::log(z);
  const double inverse = 1.0 / z;
  const double series =
      inverse * (1.0 / 12.0 - inverse * inverse * (1.0 / 360.0 - inverse * inverse / 1260.0));
  return (z - 0.5) * std::log(z) - z + 0.5 * std::log(2.0 * std::numbers::pi) + series - shift;
}

// The share of the mean square that is left of a Gaussian cut off at `cut` variances.
double ShareOfVariance(int dimension, double cut) {
  const double x = 0.5 * cut;
  const double tail = std::exp(-x);
  if (dimension == 2) return 1.0 - x * tail / -std::expm1(-x);
  const double root = std::sqrt(x);
  const double within = std::erf(root) - 2.0 * std::numbers::inv_sqrtpi * root * tail;
  return 1.0 - 4.0 / 3.0 * std::numbers::inv_sqrtpi * x * root * tail / within;
}

}  // namespace

double ExtentOf(const CalibrationProblem& problem, PairKind kind) {
  if (kind == PairKind::k3d3d) {
    Eigen::AlignedBox3d box;
    for (const Pair3d3d& pair : problem.pairs_3d3d) box.extend(pair.point_in_cam);
    return box.diagonal().norm();
  }
  Eigen::AlignedBox2d box;
  for (const Pair2d3d& pair : problem.pairs_2d3d) box.extend(pair.pixel);
  return box.diagonal().norm();
}

ScaleRater::ScaleRater(const PairScorer& scorer, double extent, int absorbed)
    : size_(scorer.size()), absorbed_(static_cast<std::size_t>(absorbed)) {
  const double least =
      std::max(std::numeric_limits<double>::min(), kMinShare * kMinShare * extent * extent);
  first_ = LeadingBits(least);
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    const auto next = static_cast<std::uint64_t>(first_ + static_cast<std::int64_t>(bin) + 1);
    upper_[bin] = std::bit_cast<double>(next << kBinShift);
    const double finest = kFinestShare * kFinestShare * extent * extent;
    chance_[bin] = std::log(scorer.RandomAgreementProbability(std::max(finest, upper_[bin])));
  }
  std::vector<double> log_factorial(size_ + 1, 0.0);
  for (std::size_t i = 1; i <= size_; ++i) {
    log_factorial[i] = log_factorial[i - 1] + std::log(static_cast<double>(i));
  }
  const auto log_choose = [&](std::size_t n, std::size_t k) {
    return log_factorial[n] - log_factorial[k] - log_factorial[n - k];
  };
  log_tests_.assign(size_ + 1, std::numeric_limits<double>::infinity());
  for (std::size_t k = absorbed_ + 1; k <= size_; ++k) {
    log_tests_[k] = std::log(static_cast<double>(size_ - absorbed_)) + log_choose(size_, k) +
                    log_choose(k, absorbed_);
  }
}

ScaleRatings ScaleRater::Rate(std::span<const double> squared) const {
  std::array<int, kBins> counts{};
  for (const double s : squared) {
    const std::int64_t bin = std::max<std::int64_t>(0, LeadingBits(s) - first_);
    if (bin < static_cast<std::int64_t>(kBins)) ++counts[static_cast<std::size_t>(bin)];
  }
  ScaleRatings best;
  best.fill({std::numeric_limits<double>::infinity(), upper_.back(), 0});
  std::size_t k = 0;
  for (std::size_t bin = 0; bin < kBins; ++bin) {
    if (counts[bin] == 0) continue;
    k += static_cast<std::size_t>(counts[bin]);
    if (k <= absorbed_) continue;
    const double rated = log_tests_[k] + static_cast<double>(k - absorbed_) * chance_[bin];
    for (std::size_t share = 0; share < best.size(); ++share) {
      if (static_cast<double>(k) > kRatedShares[share] * static_cast<double>(size_)) break;
      if (rated < best[share].log_false_alarms) {
        best[share] = {rated, upper_[bin], static_cast<int>(k)};
      }
    }
  }
  return best;
}

double LogChanceOfSelection(int dimension, std::size_t count, std::size_t inliers, double squares,
                            double squares_of_all) {
  const double a = 0.5 * (dimension * static_cast<double>(inliers) - 6.0);
  const double b = 0.5 * dimension * static_cast<double>(count - inliers);
  const double x = squares / squares_of_all;
  // The bound holds up to the mode of the beta distribution.
  if (!(a > 1.0) || !(b > 1.0) || !(x < (a - 1.0) / (a + b - 2.0))) return 0.0;
  const auto n = static_cast<double>(count);
  const auto k = static_cast<double>(inliers);
  const double log_choices = LogGamma(n + 1.0) - LogGamma(k + 1.0) - LogGamma(n - k + 1.0);
  const double log_chance =
      a * std::log(x) + (b - 1.0) * std::log1p(-x) + LogGamma(a + b) - LogGamma(a) - LogGamma(b);
  return std::min(0.0, log_choices + log_chance);
}

double VarianceWithin(std::span<const double> squared, int dimension, double unknowns,
                      double max_squared) {
  constexpr int kMaxRounds = 50;
  constexpr double kMinFreedom = 1.0;
  double sum = 0.0;
  double count = 0.0;
  for (const double s : squared) {
    if (!(s <= max_squared)) continue;
    sum += s;
    count += dimension;
  }
  const double variance = sum / std::max(kMinFreedom, count - unknowns);
  // Up to a uniform distribution, which no Gaussian explains.
  const double most = max_squared;
  double corrected = variance;
  for (int round = 0; round < kMaxRounds && corrected > 0.0; ++round) {
    const double next =
        std::min(most, variance / ShareOfVariance(dimension, max_squared / corrected));
    if (std::abs(next - corrected) < 1e-3 * corrected) return next;
    corrected = next;
  }
  return corrected;
}

}  // namespace sextant
