// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/statistics.h"

#include <algorithm>
#include <boost/math/special_functions/beta.hpp>
#include <cassert>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/random.h"

namespace sextant {
namespace {

constexpr double kNormalQuantile975 = 1.959963984540054;

// The smallest j in 1..n whose order statistic is an upper bound of the resampled k-th one with at
// least `probability`.
std::size_t RankReaching(std::size_t n, std::size_t k, double probability) {
  std::size_t low = 1;
  std::size_t high = n;
  while (low < high) {
    const std::size_t middle = (low + high) / 2;
    const double reached =
        boost::math::ibeta(static_cast<double>(k), static_cast<double>(n - k + 1),
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

double SignTest(std::uint64_t wins, std::uint64_t losses) {
  constexpr std::uint64_t kMaxExact = 1000;
  const std::uint64_t trials = wins + losses;
  if (trials == 0) return 1.0;
  const std::uint64_t fewer = std::min(wins, losses);
  const auto n = static_cast<double>(trials);
  if (trials > kMaxExact) {
    const double difference = std::abs(static_cast<double>(wins) - static_cast<double>(losses));
    return std::erfc(std::max(0.0, difference - 1.0) / std::sqrt(2.0 * n));
  }
  double tail = 0.0;
  for (std::uint64_t k = 0; k <= fewer; ++k) {
    const auto x = static_cast<double>(k);
    tail += std::exp(std::lgamma(n + 1.0) - std::lgamma(x + 1.0) - std::lgamma(n - x + 1.0) -
                     n * std::numbers::ln2);
  }
  return std::min(1.0, 2.0 * tail);
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
