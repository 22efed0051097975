// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/statistics.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "base/random.h"

namespace sextant {
namespace {

constexpr double kNormalQuantile975 = 1.959963984540054;

// The continued fraction of I_x(a, b) (Abramowitz and Stegun 26.5.8) by Lentz's method; converges
// fast for x below (a + 1) / (a + b + 2).
double BetaFraction(double a, double b, double x) {
  constexpr double kTiny = 1e-300;
  constexpr int kMaxTerms = 10000;
  const auto not_zero = [](double v) { return std::abs(v) < kTiny ? kTiny : v; };
  double c = 1.0;
  double d = 1.0 / not_zero(1.0 - (a + b) * x / (a + 1.0));
  double value = d;
  for (int m = 1; m < kMaxTerms; ++m) {
    const double even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
    d = 1.0 / not_zero(1.0 + even * d);
    c = not_zero(1.0 + even / c);
    value *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
    d = 1.0 / not_zero(1.0 + odd * d);
    c = not_zero(1.0 + odd / c);
    value *= c * d;
    if (std::abs(c * d - 1.0) < 1e-14) break;
  }
  return value;
}

// The smallest j in 1..n whose order statistic is an upper bound of the resampled k-th one with at
// least `probability`.
std::size_t RankReaching(std::size_t n, std::size_t k, double probability) {
  std::size_t low = 1;
  std::size_t high = n;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const double reached = RegularizedBeta(static_cast<double>(k), static_cast<double>(n - k + 1),
                                           static_cast<double>(middle) / static_cast<double>(n));
    if (reached >= probability) {
      high = middle;
    } else {
      low = middle + 1;
    }
  }
  return low;
}

// Sums over `batches` runs of consecutive values.
std::vector<double> BatchSums(std::span<const double> values, std::size_t batches) {
  std::vector<double> sums(batches, 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) sums[i * batches / values.size()] += values[i];
  return sums;
}

}  // namespace

double RegularizedBeta(double a, double b, double x) {
  if (x <= 0.0) return 0.0;
  if (x >= 1.0) return 1.0;
  if (x > (a + 1.0) / (a + b + 2.0)) return 1.0 - RegularizedBeta(b, a, 1.0 - x);
  int sign = 0;  // std::lgamma writes a global variable, so it is not thread-safe.
  const double log_front = lgamma_r(a + b, &sign) - lgamma_r(a, &sign) - lgamma_r(b, &sign) +
                           a * std::log(x) + b * std::log1p(-x);
  return std::exp(log_front) * BetaFraction(a, b, x) / a;
}

Interval WilsonInterval(std::uint64_t successes, std::uint64_t trials) {
  assert(trials > 0 && successes <= trials);
  const auto n = static_cast<double>(trials);
  const double p = static_cast<double>(successes) / n;
  const double z2 = kNormalQuantile975 * kNormalQuantile975;
  const double centre = (p + z2 / (2.0 * n)) / (1.0 + z2 / n);
  const double half =
      kNormalQuantile975 / (1.0 + z2 / n) * std::sqrt(p * (1.0 - p) / n + z2 / (4.0 * n * n));
  // With no or only successes the bound is exactly 0 or 1; the formula gives it up to rounding.
  return {successes == 0 ? 0.0 : centre - half, successes == trials ? 1.0 : centre + half};
}

QuantilePlace PlaceOfQuantile(std::uint64_t count, double q) {
  assert(count > 0 && q >= 0.0 && q <= 1.0);
  const double position = q * static_cast<double>(count - 1);
  const auto below = static_cast<std::uint64_t>(position);
  if (below + 1 >= count) return {count - 1, count - 1, 0.0};
  return {below, below + 1, position - static_cast<double>(below)};
}

double QuantileOfSorted(std::span<const double> sorted, double q) {
  const QuantilePlace place = PlaceOfQuantile(sorted.size(), q);
  return place.Between(sorted[place.below], sorted[place.above]);
}

RankInterval QuantileIntervalRanks(std::uint64_t count, double q) {
  const auto k = static_cast<std::uint64_t>(std::lround(q * static_cast<double>(count - 1))) + 1;
  return {RankReaching(count, k, 0.025) - 1, RankReaching(count, k, 0.975) - 1};
}

Interval QuantileInterval(std::span<const double> sorted, double q) {
  const RankInterval ends = QuantileIntervalRanks(sorted.size(), q);
  return {sorted[ends.low], sorted[ends.high]};
}

Interval BootstrapRatio(std::span<const double> numerators, std::span<const double> denominators,
                        std::uint64_t seed) {
  assert(!numerators.empty() && numerators.size() == denominators.size());
  constexpr std::size_t kResamples = 1000;
  const std::size_t batches = std::min<std::size_t>(numerators.size(), kBootstrapRuns);
  const std::vector<double> above = BatchSums(numerators, batches);
  const std::vector<double> below = BatchSums(denominators, batches);
  Random random(seed);
  std::vector<double> ratios;
  ratios.reserve(kResamples);
  for (std::size_t r = 0; r < kResamples; ++r) {
    double numerator = 0.0;
    double denominator = 0.0;
    for (std::size_t i = 0; i < batches; ++i) {
      const auto drawn = static_cast<std::size_t>(random.Below(batches));
      numerator += above[drawn];
      denominator += below[drawn];
    }
    ratios.push_back(numerator / denominator);
  }
  std::sort(ratios.begin(), ratios.end());
  return {QuantileOfSorted(ratios, 0.025), QuantileOfSorted(ratios, 0.975)};
}

}  // namespace sextant
