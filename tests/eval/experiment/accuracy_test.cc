// SPDX-License-Identifier: Apache-2.0
// Accuracy of the solvers, measured by experiments.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "eval/experiment/report/report.h"
#include "eval/experiment/run/run_trials.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

// RMS divided by the bound for a single solver and condition, without gross errors.
double Efficiency(const Experiment& experiment, const ReportData& data, const std::string& of) {
  const std::string unit = of == "rotation" ? "_deg" : "_mm";
  const Statistic statistic = *ParseStatistic(
      "efficiency(" + of + unit + ",bound_" + of + unit + ",where=fine)", experiment.metrics);
  return data.figures(0, statistic).front().value;
}

struct Accuracy {
  double rotation = 0.0;  // RMS divided by the bound.
  double translation = 0.0;
  double fine = 0.0;  // Fraction of trials without gross errors.
};

Accuracy Measure(const std::string& solver, int seed, int trials, const std::string& parameters) {
  const Experiment experiment = *ParseExperiment(
      "kind: random_scene\nseed: " + std::to_string(seed) + "\ntrials: " + std::to_string(trials) +
          "\nsolvers: ['" + solver + "']\nparameters: {" + parameters +
          "}\nmetrics: []\ntables: [{columns: ['efficiency(rotation_deg, bound_rotation_deg, "
          "where=fine)', 'efficiency(translation_mm, bound_translation_mm, where=fine)', "
          "rate(fine)]}]\n",
      "accuracy.yaml", BuiltinKinds(), BuiltinSolvers());
  const std::filesystem::path rows = TestFolder() / "rows";
  EXPECT_TRUE(RunTrials(experiment, {.rows_path = rows, .fresh = true}));
  const RowFileReader reader = *RowFileReader::Open(rows);
  const ReportData data = *ReportData::Compute(experiment, reader);
  const Statistic fine = *ParseStatistic("rate(fine)", experiment.metrics);
  return {Efficiency(experiment, data, "rotation"), Efficiency(experiment, data, "translation"),
          data.figures(0, fine).front().value};
}

TEST(Accuracy, KabschWithIsotropicNoiseMeetsTheBound) {
  // The maximum likelihood estimate; with 1000 trials of 3 degrees of freedom each, the ratio has a
  // standard error of 1 / sqrt(2 * 3000) = 0.013.
  const Accuracy kabsch = Measure("kabsch", 1, 1000, "data: points, pairs: 10");
  EXPECT_EQ(kabsch.fine, 1.0);
  EXPECT_NEAR(kabsch.rotation, 1.0, 5 * 0.013);
  EXPECT_NEAR(kabsch.translation, 1.0, 5 * 0.013);
}

TEST(Accuracy, OutliersOnlyAffectLeastSquares) {
  const std::string parameters = "data: points, pairs: 10, outliers: 0.3";
  EXPECT_GT(Measure("kabsch", 3, 100, parameters).rotation, 5.0);
  const Accuracy robust = Measure("ransac(kabsch)", 3, 100, parameters);
  EXPECT_EQ(robust.fine, 1.0);
  EXPECT_LT(robust.rotation, 1.5);
}

struct PixelGoal {
  const char* solver;
  double most;  // Maximum of the root mean square error divided by the bound.
};

// The figures of docs/accuracy.md with 2000 trials. The ratio of root mean squares has a standard
// error of sqrt(c / (2 * 3 * trials)); c is 1 if all scenes are equivalent. Measured over 12 seeds
// it is about 5 for 6 pairs, as some viewpoints determine the pose badly, and 2 from 8 pairs on.
// Three standard errors are allowed; those 12 seeds had means of at most 1.01 and 1.09.
TEST(Accuracy, PixelSolversStayNearTheBound) {
  constexpr int kTrials = 1000;
  for (const PixelGoal& goal : {PixelGoal{"refine(epnp)", 1.05}, PixelGoal{"sqpnp", 1.15}}) {
    for (const int pairs : {6, 8, 20, 100}) {
      const double chance = 3.0 * std::sqrt((pairs == 6 ? 5.0 : 2.0) / (6.0 * kTrials));
      const Accuracy found =
          Measure(goal.solver, 4, kTrials, "data: pixels, pairs: " + std::to_string(pairs));
      EXPECT_EQ(found.fine, 1.0) << goal.solver << pairs;
      EXPECT_LT(found.rotation, goal.most + chance) << goal.solver << pairs;
      EXPECT_LT(found.translation, goal.most + chance) << goal.solver << pairs;
    }
  }
}

}  // namespace
}  // namespace sextant::test
