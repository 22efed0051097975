// SPDX-License-Identifier: Apache-2.0
#include "eval/statistics/statistics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "base/random.h"

namespace sextant {
namespace {

TEST(WilsonInterval, MatchesThePaperAndIsNeverEmpty) {
  // 7 of 10: the roots of (p - 0.7)^2 = z^2 p (1 - p) / 10.
  const Interval interval = WilsonInterval(7, 10);
  for (const double p : {interval.low, interval.high}) {
    EXPECT_NEAR((p - 0.7) * (p - 0.7), 1.959963985 * 1.959963985 * p * (1.0 - p) / 10.0, 1e-9);
  }
  EXPECT_EQ(WilsonInterval(0, 50).low, 0.0);
  EXPECT_GT(WilsonInterval(0, 50).high, 0.05);
  EXPECT_EQ(WilsonInterval(50, 50).high, 1.0);
  EXPECT_LT(WilsonInterval(50, 50).low, 0.95);
}

TEST(QuantileOfSorted, InterpolatesBetweenOrderStatistics) {
  const std::vector<double> values = {1.0, 2.0, 4.0, 8.0};
  EXPECT_EQ(QuantileOfSorted(values, 0.0), 1.0);
  EXPECT_EQ(QuantileOfSorted(values, 0.5), 3.0);
  EXPECT_EQ(QuantileOfSorted(values, 1.0), 8.0);
  EXPECT_EQ(QuantileOfSorted(std::vector<double>{5.0}, 0.3), 5.0);
}

// 20000 drawn resamples give the same interval up to sampling error: a standard error of sqrt(0.025
// * 0.975 / 20000) = 0.0011 in probability, which may shift a rank by one.
TEST(QuantileInterval, IsTheLimitOfTheResampledBootstrap) {
  constexpr int kSize = 41;
  std::vector<double> values(kSize);
  std::iota(values.begin(), values.end(), 1.0);
  for (const double q : {0.5, 0.9}) {
    Random random(3);
    std::vector<double> drawn;
    for (int r = 0; r < 20000; ++r) {
      std::vector<double> resample;
      for (int i = 0; i < kSize; ++i) resample.push_back(values[random.Below(kSize)]);
      std::sort(resample.begin(), resample.end());
      drawn.push_back(QuantileOfSorted(resample, q));
    }
    std::sort(drawn.begin(), drawn.end());
    const Interval exact = QuantileInterval(values, q);
    EXPECT_NEAR(exact.low, QuantileOfSorted(drawn, 0.025), 1.0) << q;
    EXPECT_NEAR(exact.high, QuantileOfSorted(drawn, 0.975), 1.0) << q;
  }
}

// Coverage of the truth. 600 repetitions have a standard error of 0.9 percent; the percentile
// bootstrap of a root mean square of 60 values covers about 93 percent.
TEST(Intervals, HaveTheirNominalCoverage) {
  constexpr int kRepetitions = 600;
  constexpr int kSize = 60;
  int median = 0;
  int square = 0;
  Random random(7);
  for (int r = 0; r < kRepetitions; ++r) {
    std::vector<double> values;
    std::vector<double> squares;
    for (int i = 0; i < kSize; ++i) {
      values.push_back(random.Normal());
      squares.push_back(values.back() * values.back());
    }
    std::sort(values.begin(), values.end());
    const Interval of_median = QuantileInterval(values, 0.5);
    median += of_median.low <= 0.0 && 0.0 <= of_median.high ? 1 : 0;
    const Interval of_square =
        BootstrapRatio(squares, std::vector<double>(kSize, 1.0), static_cast<std::uint64_t>(r));
    square += of_square.low <= 1.0 && 1.0 <= of_square.high ? 1 : 0;
  }
  EXPECT_GT(median, 0.92 * kRepetitions);
  EXPECT_LT(median, 0.985 * kRepetitions);
  EXPECT_GT(square, 0.895 * kRepetitions);
  EXPECT_LT(square, 0.975 * kRepetitions);
}

TEST(BootstrapRatio, HasTheWidthOfTheNormalIntervalForManyValues) {
  Random random(11);
  std::vector<double> values;
  for (int i = 0; i < 50000; ++i) values.push_back(3.0 + random.Normal());
  const std::vector<double> ones(values.size(), 1.0);
  const Interval interval = BootstrapRatio(values, ones, 1);
  const double width = 2.0 * 1.96 / std::sqrt(50000.0);
  // 200 batches and 1000 resamples leave each end a few percent.
  EXPECT_NEAR(interval.high - interval.low, width, 0.15 * width);
  EXPECT_EQ(interval.low, BootstrapRatio(values, ones, 1).low);
  EXPECT_NE(interval.low, BootstrapRatio(values, ones, 2).low);
}

}  // namespace
}  // namespace sextant
