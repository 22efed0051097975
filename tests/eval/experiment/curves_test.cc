// SPDX-License-Identifier: Apache-2.0
// Ranks, areas and plots of single trials.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/report/figure.h"
#include "eval/experiment/report/rank_table.h"
#include "eval/statistics/statistics.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

using testing::HasSubstr;

constexpr double kFailed = std::numeric_limits<double>::quiet_NaN();

TEST(SignTest, IsThatOfTheBinomialDistribution) {
  EXPECT_EQ(SignTest(0, 0), 1.0);
  EXPECT_EQ(SignTest(3, 3), 1.0);
  EXPECT_NEAR(SignTest(0, 5), 2.0 / 32.0, 1e-12);
  EXPECT_NEAR(SignTest(9, 1), 2.0 * 11.0 / 1024.0, 1e-12);
  EXPECT_NEAR(SignTest(480, 520), SignTest(481, 521), 0.01);
  EXPECT_LT(SignTest(1000, 4000), 1e-12);
}

TEST(RankTable, CountsFailedTrialsAsTheWorst) {
  const std::vector<std::string> names = {"easy", "sure", "bad"};
  // `easy` is the best where it answers, which it does in two of five trials.
  const std::vector<std::vector<double>> errors = {
      {1, 1, kFailed, kFailed, kFailed}, {2, 2, 2, 2, 2}, {3, 3, 3, kFailed, 3}};
  const std::string text = RankTable(names, errors).Plain();
  EXPECT_LT(text.find("sure"), text.find("easy"));
  // Ranks 1, 1, 3, 2.5, 3 and 2, 2, 1, 1, 1.
  EXPECT_THAT(text, HasSubstr("2.10"));
  EXPECT_THAT(text, HasSubstr("1.40"));
  EXPECT_THAT(text, HasSubstr("3/5"));
  EXPECT_THAT(text, HasSubstr("40.0 %"));
}

TEST(Area, IsTheMeanOfWhatIsLeftUpToTheLimit) {
  const std::vector<Metric> metrics = {{"error", "an error"}};
  const Expected<Statistic> area = ParseStatistic("auc(error, limit=10)", metrics);
  ASSERT_TRUE(area) << area.error().message;
  FigureGatherer gatherer(*area, 1);
  while (!gatherer.done()) {
    for (const double error : {0.0, 5.0, 20.0, kFailed}) gatherer.Add(error, 0.0, 0.0);
    gatherer.EndPass();
  }
  EXPECT_NEAR(gatherer.figure().value, (1.0 + 0.5) / 4.0, 1e-12);
  EXPECT_EQ(gatherer.figure().trials, 4U);
  EXPECT_FALSE(ParseStatistic("auc(error)", metrics));
}

TEST(Figure, TellsHowManyTrialsItCovers) {
  const std::vector<Metric> metrics = {{"error", "an error"}};
  FigureGatherer gatherer(ParseStatistic("median(error)", metrics).value(), 1);
  while (!gatherer.done()) {
    for (const double error : {1.0, 2.0, kFailed}) gatherer.Add(error, 0.0, 0.0);
    gatherer.EndPass();
  }
  EXPECT_EQ(gatherer.figure().trials, 2U);
  EXPECT_EQ(gatherer.figure().all_trials, 3U);
}

std::string ErrorOf(const std::string& plot) {
  const Expected<Experiment> experiment = ParseExperiment(
      "kind: random_scene\ntrials: 2\nsolvers: [kabsch]\nparameters: {data: points}\nplots:\n  - "
      "{" +
          plot + "}\n",
      "e.yaml", BuiltinKinds(), BuiltinSolvers());
  return experiment ? "" : experiment.error().message;
}

TEST(Plots, EveryTypeIsChecked) {
  EXPECT_EQ(ErrorOf("type: cdf, x: translation_mm, max: 50"), "");
  EXPECT_EQ(ErrorOf("type: coverage, x: nees"), "");
  EXPECT_THAT(ErrorOf("type: cfd, x: translation_mm"), HasSubstr("did you mean 'cdf'?"));
  EXPECT_THAT(ErrorOf("type: cdf, x: translation_m"), HasSubstr("unknown metric"));
  EXPECT_THAT(ErrorOf("type: time, y: median(translation_mm)"), HasSubstr("needs timed_trials"));
  EXPECT_THAT(ErrorOf("type: cdf, x: nees, condition: none"),
              HasSubstr("no condition has the name"));
}

}  // namespace
}  // namespace sextant
