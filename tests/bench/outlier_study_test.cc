// SPDX-License-Identifier: Apache-2.0
#include "bench/outlier_study.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant {
namespace {

Contestant Make(const char* spec) { return ContestantOf(*BuiltinSolvers().Make(spec)); }

TEST(OutlierStudy, SeparatesRobustSolversFromOthers) {
  const std::vector<Contestant> contestants = {
      Make("ransac(p3p)"),
      Make("refine(epnp)"),
      {"refuses", [](const CalibrationProblem&) { return std::nullopt; }},
      {"guesses", [](const CalibrationProblem&) { return Rigid3d{}; }},
      ContestantThatKnowsInliers(*BuiltinSolvers().Make("refine(epnp)"))};
  const OutlierStudy study{.scenes = 20, .pairs = {100}, .outlier_fractions = {0.0, 0.5}};
  const std::vector<OutlierCell> cells = StudyOutliers(study, contestants);
  ASSERT_EQ(cells.size(), 10U);
  EXPECT_EQ(cells[0].successes, 20);
  EXPECT_EQ(cells[1].successes, 20);
  EXPECT_EQ(cells[2].successes, 20);
  EXPECT_EQ(cells[3].successes, 0) << "least squares follows the outliers, or explains nothing";
  EXPECT_EQ(cells[5].unanswered, 20);
  EXPECT_EQ(cells[7].successes, 0);
  EXPECT_EQ(cells[7].unanswered, 0);
  EXPECT_EQ(cells[9].successes, 20);
  EXPECT_EQ(cells[9].contestant, "refine(epnp), inliers known");
  const std::string table = OutlierTable(cells, 100).Plain();
  EXPECT_THAT(table, testing::HasSubstr("50 %"));
  // In brackets the wrong answers; refusals are none.
  EXPECT_THAT(table, testing::HasSubstr("0 (20)"));
}

// The goals that bench_outliers checks in the whole study, here in the most important cells.
TEST(OutlierStudy, RansacSolvesAllScenesAtAHundredPairs) {
  const std::vector<Contestant> contestants = {Make("refine(ransac(p3p))"), Make("ransac(epnp)")};
  const OutlierStudy study{.pairs = {100}, .outlier_fractions = {0.0, 0.3, 0.5}};
  for (const OutlierCell& cell : StudyOutliers(study, contestants)) {
    EXPECT_EQ(cell.successes, 100) << cell.contestant << " at " << cell.outlier_fraction;
  }
}

TEST(OutlierStudy, ResultsDoNotDependOnThreads) {
  const std::vector<Contestant> contestants = {Make("ransac(p3p)")};
  OutlierStudy study{.scenes = 30, .threads = 1, .pairs = {20}, .outlier_fractions = {0.6}};
  const int alone = StudyOutliers(study, contestants).front().successes;
  study.threads = 3;
  EXPECT_EQ(StudyOutliers(study, contestants).front().successes, alone);
}

}  // namespace
}  // namespace sextant
