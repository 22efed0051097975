// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/gather.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"

namespace sextant {
namespace {

// Numbers of all magnitudes and both signs, many of them equal.
std::vector<double> ManyValues(std::size_t count) {
  Random random(5);
  std::vector<double> values = {0.0,
                                -0.0,
                                std::numeric_limits<double>::infinity(),
                                -std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::denorm_min(),
                                -5e-320,
                                std::numeric_limits<double>::max()};
  while (values.size() < count) {
    const double normal = random.Normal();
    const double magnitude = random.Uniform(-300.0, 300.0);
    values.push_back(normal * std::pow(10.0, magnitude));
    values.push_back(std::round(normal * 3.0));
    values.push_back(1.0 + 1e-15 * std::round(normal));
  }
  values.resize(count);
  return values;
}

template <class Gatherer>
void PassAll(const std::vector<double>& values, Gatherer& gatherer) {
  for (int pass = 0; pass < Gatherer::kPasses; ++pass) {
    for (const double value : values) gatherer.Add(value);
    gatherer.EndPass();
  }
}

TEST(RankSelector, FindsEveryOrderStatistic) {
  std::vector<double> values = ManyValues(1000);
  std::vector<std::uint64_t> ranks(values.size());
  for (std::size_t i = 0; i < ranks.size(); ++i) ranks[i] = i;
  RankSelector selector(ranks);
  PassAll(values, selector);
  std::sort(values.begin(), values.end());
  for (std::size_t i = 0; i < values.size(); ++i) EXPECT_EQ(selector.ValueAt(i), values[i]) << i;
}

TEST(RankSelector, HandlesOneValue) {
  RankSelector selector({0});
  PassAll({-2.5}, selector);
  EXPECT_EQ(selector.ValueAt(0), -2.5);
}

TEST(QuantileGatherer, AgreesWithSortedValues) {
  for (const std::size_t count :
       {std::size_t{1}, std::size_t{2}, std::size_t{7}, std::size_t{5000}}) {
    std::vector<double> values;
    Random random(count);
    while (values.size() < count) values.push_back(random.Normal());
    const std::vector<double> quantiles = {0.0, 0.05, 0.5, 0.95, 1.0};
    std::vector<QuantileGatherer::Wanted> wanted;
    for (const double q : quantiles) wanted.push_back({q, true});
    QuantileGatherer gatherer(count, wanted);
    PassAll(values, gatherer);
    std::sort(values.begin(), values.end());
    for (const double q : quantiles) {
      EXPECT_EQ(gatherer.Quantile(q), QuantileOfSorted(values, q)) << q << " of " << count;
      EXPECT_EQ(gatherer.IntervalOf(q).low, QuantileInterval(values, q).low);
      EXPECT_EQ(gatherer.IntervalOf(q).high, QuantileInterval(values, q).high);
    }
  }
}

TEST(RatioSums, MatchBootstrapRatio) {
  for (const std::size_t count :
       {std::size_t{1}, std::size_t{200}, std::size_t{201}, std::size_t{5003}}) {
    Random random(count);
    std::vector<double> numerators;
    std::vector<double> denominators;
    RatioSums sums(count);
    while (numerators.size() < count) {
      numerators.push_back(random.Uniform(0.0, 3.0));
      denominators.push_back(random.Uniform(1.0, 2.0));
      sums.Add(numerators.back(), denominators.back());
    }
    const Interval expected = BootstrapRatio(numerators, denominators, 9);
    EXPECT_EQ(sums.BootstrapInterval(9).low, expected.low) << count;
    EXPECT_EQ(sums.BootstrapInterval(9).high, expected.high) << count;
    double above = 0.0;
    double below = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      above += numerators[i];
      below += denominators[i];
    }
    EXPECT_EQ(sums.ratio(), above / below);
  }
}

}  // namespace
}  // namespace sextant
