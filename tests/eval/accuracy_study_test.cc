// SPDX-License-Identifier: Apache-2.0
#include "eval/accuracy_study.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "solvers/registry.h"

namespace sextant {
namespace {

AccuracyResult StudyKabsch(const AccuracyStudy& study) {
  const std::vector<SolverPtr> solvers = {*BuiltinSolvers().Make("kabsch")};
  const AccuracyCondition condition{
      .name = "points", .scene = {.pairs = 10, .sigma_m = 0.01}, .outlier_fraction = 0.0};
  return StudyAccuracy(study, condition, solvers).front();
}

TEST(AccuracyStudy, KabschWithIsotropicNoiseMeetsTheBound) {
  // The maximum likelihood estimate; 1000 trials of 3 degrees of freedom each leave the ratio a
  // standard error of 1 / sqrt(2 * 3000) = 0.013.
  const AccuracyResult result = StudyKabsch({.seed = 1, .trials = 1000});
  EXPECT_EQ(result.trials, 1000);
  EXPECT_EQ(result.unanswered + result.gross, 0);
  EXPECT_NEAR(result.RotationRatio(), 1.0, 5 * 0.013);
  EXPECT_NEAR(result.TranslationRatio(), 1.0, 5 * 0.013);
}

TEST(AccuracyStudy, FiguresDoNotDependOnThreads) {
  const AccuracyResult one = StudyKabsch({.seed = 2, .trials = 50, .threads = 1});
  const AccuracyResult three = StudyKabsch({.seed = 2, .trials = 50, .threads = 3});
  EXPECT_EQ(one.rotation_rad, three.rotation_rad);
  EXPECT_EQ(one.translation_m, three.translation_m);
}

TEST(AccuracyStudy, OutliersRuinLeastSquaresOnly) {
  const AccuracyCondition condition{
      .name = "outliers", .scene = {.pairs = 10, .sigma_m = 0.01}, .outlier_fraction = 0.3};
  const std::vector<SolverPtr> solvers = {*BuiltinSolvers().Make("kabsch")};
  const AccuracyResult result =
      StudyAccuracy({.seed = 3, .trials = 100}, condition, solvers).front();
  EXPECT_GT(result.gross + result.unanswered + (result.RotationRatio() > 5.0 ? result.trials : 0),
            50);
}

struct PixelGoal {
  const char* solver;
  double most;  // Of the root mean square error over the bound.
};

// What docs/accuracy.md shows at 2000 trials. The ratio of root mean squares has a standard error
// of sqrt(c / (2 * 3 * trials)); c is 1 where all scenes are alike. Measured over 12 seeds it is
// about 5 for 6 pairs, some of which see the scene from where it tells little, and 2 from 8 on.
// Three standard errors are allowed; those 12 seeds had means of at most 1.01 and 1.09.
TEST(AccuracyStudy, SolversOfPixelsStayNearTheBound) {
  constexpr int kTrials = 1000;
  const PixelGoal goals[] = {{"refine(epnp)", 1.05}, {"sqpnp", 1.15}};
  std::vector<SolverPtr> solvers;
  for (const PixelGoal& goal : goals) solvers.push_back(*BuiltinSolvers().Make(goal.solver));
  for (const int pairs : {6, 8, 20, 100}) {
    const double chance = 3.0 * std::sqrt((pairs == 6 ? 5.0 : 2.0) / (6.0 * kTrials));
    const AccuracyCondition condition{.name = std::to_string(pairs) + " pixels",
                                      .scene = {.pairs = pairs, .sigma_px = 1.0},
                                      .outlier_fraction = 0.0};
    const auto results = StudyAccuracy({.seed = 4, .trials = kTrials}, condition, solvers);
    for (std::size_t k = 0; k < results.size(); ++k) {
      EXPECT_EQ(results[k].unanswered + results[k].gross, 0) << goals[k].solver << pairs;
      EXPECT_LT(results[k].RotationRatio(), goals[k].most + chance) << goals[k].solver << pairs;
      EXPECT_LT(results[k].TranslationRatio(), goals[k].most + chance) << goals[k].solver << pairs;
    }
  }
}

}  // namespace
}  // namespace sextant
