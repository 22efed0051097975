// SPDX-License-Identifier: Apache-2.0
#include "eval/accuracy_study.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sextant
