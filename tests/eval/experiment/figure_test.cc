// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/figure.h"

#include <gtest/gtest.h>

#include <cmath>

namespace sextant {
namespace {

const std::vector<Metric>& Metrics() {
  static const std::vector<Metric> metrics = {{"error", "e"}, {"bound", "b"}, {"fine", "f"}};
  return metrics;
}

const double kNone = std::nan("");

Figure Compute(const std::string& statistic, const std::vector<double>& values,
               const std::vector<double>& reference = {}, const std::vector<double>& where = {}) {
  FigureGatherer gatherer(*ParseStatistic(statistic, Metrics()), 1);
  while (!gatherer.done()) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      gatherer.Add(values[i], reference.empty() ? kNone : reference[i],
                   where.empty() ? kNone : where[i]);
    }
    gatherer.EndPass();
  }
  return gatherer.figure();
}

TEST(Figure, ComputesEachKindOfStatistic) {
  const std::vector<double> values = {3.0, kNone, -4.0};
  EXPECT_DOUBLE_EQ(Compute("mean(error)", values).value, -0.5);
  EXPECT_DOUBLE_EQ(Compute("rms(error)", values).value, std::sqrt(12.5));
  EXPECT_DOUBLE_EQ(Compute("sd(error)", values).value, 3.5);
  EXPECT_DOUBLE_EQ(Compute("median(error)", values).value, -0.5);
  EXPECT_DOUBLE_EQ(Compute("min(error)", values).value, -4.0);
  EXPECT_DOUBLE_EQ(Compute("max(error)", values).value, 3.0);
  EXPECT_DOUBLE_EQ(Compute("p25(error)", values).value, -2.25);
  EXPECT_EQ(Compute("mean(error)", values).trials, 2U);
  EXPECT_FALSE(Compute("max(error)", values).interval);
}

TEST(Figure, RateCountsMissingTrialsAsFailures) {
  const Figure rate = Compute("rate(fine)", {1.0, 1.0, 0.0, kNone});
  EXPECT_DOUBLE_EQ(rate.value, 0.5);
  EXPECT_EQ(rate.trials, 4U);
  EXPECT_EQ(rate.interval->low, WilsonInterval(2, 4).low);
}

TEST(Figure, EfficiencyUsesTheSameTrialsForBothMetrics) {
  const Figure figure = Compute("efficiency(error, bound)", {2.0, 6.0, kNone}, {1.0, 3.0, 100.0});
  EXPECT_DOUBLE_EQ(figure.value, 2.0);
  EXPECT_DOUBLE_EQ(figure.interval->low, 2.0) << "every trial has this ratio";
  EXPECT_EQ(figure.trials, 2U);
}

TEST(Figure, WhereSelectsTrials) {
  const Figure figure = Compute("mean(error, where=fine)", {1.0, 100.0, 3.0}, {}, {1.0, 0.0, 1.0});
  EXPECT_DOUBLE_EQ(figure.value, 2.0);
}

TEST(Figure, IsNanWithoutTrials) {
  EXPECT_TRUE(std::isnan(Compute("rms(error)", {kNone, kNone}).value));
  EXPECT_EQ(Compute("median(error)", {}).trials, 0U);
}

TEST(Statistic, TextIsCanonicalWithOptions) {
  const Expected<Statistic> statistic =
      ParseStatistic("efficiency( error,bound, where = fine, decimals=1)", Metrics());
  ASSERT_TRUE(statistic) << statistic.error().message;
  EXPECT_EQ(statistic->text, "efficiency(error,bound,where=fine,decimals=1)");
  EXPECT_EQ(statistic->reference, 1);
  EXPECT_EQ(statistic->where, 2);
  EXPECT_EQ(statistic->decimals, 1);
  EXPECT_FALSE(ParseStatistic("p100(error)", Metrics()));
  EXPECT_FALSE(ParseStatistic("mean(time_us)", Metrics()));
}

}  // namespace
}  // namespace sextant
