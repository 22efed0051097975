// SPDX-License-Identifier: Apache-2.0
#include "eval/view_study.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solvers/registry.h"

namespace sextant {
namespace {

std::vector<SolverPtr> Solvers(const std::vector<std::string>& specs) {
  std::vector<SolverPtr> solvers;
  for (const std::string& spec : specs) solvers.push_back(*BuiltinSolvers().Make(spec));
  return solvers;
}

// The goals of the joint solver: within 1.3 of the bound, a covariance with a NEES of 0.9 to 1.1
// and better than every two-stage solver on the same sessions. The NEES of n trials has a standard
// error of sqrt(1 / (3 n)), of which three are allowed beside the goal.
TEST(ViewStudy, JointIsAtTheBoundAndAheadOfTwoStageSolvers) {
  struct Case {
    int views;
    int trials;
  };
  const std::vector<SolverPtr> solvers =
      Solvers({"joint(kabsch)", "kabsch", "refine(kabsch)", "gnc(kabsch)", "average(kabsch)",
               "epnp", "refine(epnp)"});
  for (const Case& at : {Case{2, 200}, Case{4, 200}, Case{20, 60}, Case{100, 24}}) {
    SCOPED_TRACE(at.views);
    const ViewStudy study{.seed = 1, .trials = at.trials};
    const auto results = StudyViews(study, at.views, solvers);
    ASSERT_TRUE(results) << results.error().message;
    const ViewResult& joint = results->front();
    EXPECT_EQ(joint.unanswered, 0);
    EXPECT_LT(joint.RotationRatio(), 1.3);
    EXPECT_LT(joint.TranslationRatio(), 1.3);
    const double slack = 3.0 * std::sqrt(1.0 / (3.0 * at.trials));
    EXPECT_GT(joint.nees, 0.9 - slack);
    EXPECT_LT(joint.nees, 1.1 + slack);
    for (std::size_t k = 1; k < results->size(); ++k) {
      const ViewResult& other = (*results)[k];
      EXPECT_LT(joint.rotation_rad, other.rotation_rad) << other.solver;
      EXPECT_LT(joint.translation_m, other.translation_m) << other.solver;
    }
  }
}

TEST(ViewStudy, DoesNotDependOnTheNumberOfThreads) {
  const std::vector<SolverPtr> solvers = Solvers({"joint(kabsch)"});
  ViewStudy study{.seed = 2, .trials = 6, .threads = 1};
  const auto alone = StudyViews(study, 3, solvers);
  study.threads = 3;
  const auto together = StudyViews(study, 3, solvers);
  ASSERT_TRUE(alone && together);
  EXPECT_EQ(alone->front().translation_m, together->front().translation_m);
  EXPECT_EQ(alone->front().nees, together->front().nees);
}

}  // namespace
}  // namespace sextant
