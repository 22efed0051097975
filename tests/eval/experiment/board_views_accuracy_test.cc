// SPDX-License-Identifier: Apache-2.0
// Accuracy of joint on raw views of boards, measured as in experiments/board_views.yaml.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "eval/experiment/report/report.h"
#include "eval/experiment/run/run_trials.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

struct Measured {
  const ReportData& data;
  const Experiment& experiment;

  // One figure per solver.
  std::vector<Figure> Of(const std::string& statistic) const {
    return data.figures(0, *ParseStatistic(statistic, experiment.metrics));
  }
};

// The goals: joint is within a factor of 1.3 of the bound, its covariance has a NEES of 0.9 to 1.1
// per degree of freedom, and it is better than every two-stage solver on the same sessions. The
// NEES of n trials has a standard error of sqrt(1 / (3 n)), of which three are allowed in addition;
// the RMS over three axes has one of sqrt(1 / (6 n)), 10 percent of 16 trials.
TEST(BoardViews, JointIsNearTheBoundAndBetterThanTwoStageSolvers) {
  struct Case {
    int views;
    int trials;
    const char* azimuth_step_deg;  // Few returns take less time, and show little less.
  };
  for (const Case& at :
       {Case{2, 200, "0.6"}, Case{4, 200, "0.6"}, Case{20, 60, "0.6"}, Case{100, 16, "0.2"}}) {
    SCOPED_TRACE(at.views);
    const Experiment experiment = *ParseExperiment(
        "kind: board_views\nseed: 1\ntrials: " + std::to_string(at.trials) +
            "\nsolvers: [joint(kabsch), kabsch, refine(kabsch), gnc(kabsch), average(kabsch), "
            "epnp, refine(epnp)]\nparameters: {views: " +
            std::to_string(at.views) + ", azimuth_step_deg: " + at.azimuth_step_deg +
            "}\nmetrics: []\ntables: [{columns: [rms(rotation_deg), rms(translation_mm), "
            "mean(nees), rate(answered), 'efficiency(rotation_deg, bound_rotation_deg)', "
            "'efficiency(translation_mm, bound_translation_mm)']}]\n",
        "board_views.yaml", BuiltinKinds(), BuiltinSolvers());
    const std::filesystem::path rows = TestFolder() / "rows";
    ASSERT_TRUE(RunTrials(experiment, {.rows_path = rows, .fresh = true}));
    const RowFileReader reader = *RowFileReader::Open(rows);
    const ReportData data = *ReportData::Compute(experiment, reader);
    const Measured measured{data, experiment};
    EXPECT_EQ(measured.Of("rate(answered)").front().value, 1.0);
    EXPECT_LT(measured.Of("efficiency(rotation_deg,bound_rotation_deg)").front().value, 1.3);
    EXPECT_LT(measured.Of("efficiency(translation_mm,bound_translation_mm)").front().value, 1.3);
    EXPECT_NEAR(measured.Of("mean(nees)").front().value / 6.0, 1.0,
                0.1 + 3.0 * std::sqrt(1.0 / (3.0 * at.trials)));
    for (const char* error : {"rms(rotation_deg)", "rms(translation_mm)"}) {
      const std::vector<Figure> figures = measured.Of(error);
      ASSERT_EQ(figures.size(), 7u);
      for (std::size_t k = 1; k < figures.size(); ++k) {
        EXPECT_LT(figures[0].value, figures[k].value) << error << " of solver " << k;
      }
    }
  }
}

}  // namespace
}  // namespace sextant::test
