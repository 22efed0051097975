// SPDX-License-Identifier: Apache-2.0
// Solvers on the 40 real board placements of acfr/cam_lidar_calibration.
#include "io/problems/acfr_poses.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant {
namespace {

CalibrationProblem AllPlacements(const std::filesystem::path& path) {
  const auto poses = ReadAcfrPoses(path);
  EXPECT_TRUE(poses) << poses.error().message;
  const auto problem = ProblemFromAcfrPoses(*poses, AcfrPoints::kCornersAndCentres);
  EXPECT_TRUE(problem) << problem.error().message;
  return *problem;
}

TEST(AcfrPoses, KabschOfAllPairsHasTheKnownError) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const Expected<SolveReport> report =
      (*BuiltinSolvers().Make("kabsch"))->Solve(AllPlacements(path));
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_NEAR(*report->evaluation.rmse_m, 0.01615, 2e-5);
}

// Cross-validation with eight folds over whole placements: rejecting outliers must not increase the
// error on held-out placements.
TEST(AcfrPoses, RobustSolversAreNeverWorseOnHeldOutPlacements) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const CalibrationProblem problem = AllPlacements(path);
  constexpr int kFolds = 8;
  const auto held_out_rmse = [&problem](const char* spec) {
    const SolverPtr solver = *BuiltinSolvers().Make(spec);
    double squares = 0.0;
    for (int fold = 0; fold < kFolds; ++fold) {
      CalibrationProblem training;
      CalibrationProblem held_out;
      for (const Pair3d3d& pair : problem.pairs_3d3d) {
        (pair.id.view % kFolds == fold ? held_out : training).pairs_3d3d.push_back(pair);
      }
      const Expected<SolveReport> report = solver->Solve(training);
      EXPECT_TRUE(report) << report.error().message;
      for (const double r : Evaluate(held_out, report->cam_from_lidar).per_pair_m) squares += r * r;
    }
    return std::sqrt(squares / static_cast<double>(problem.pairs_3d3d.size()));
  };
  const double kabsch = held_out_rmse("kabsch");
  EXPECT_LE(held_out_rmse("gnc(kabsch)"), kabsch * (1.0 + 1e-9));
  EXPECT_LE(held_out_rmse("ransac(kabsch)"), kabsch * (1.0 + 1e-9));
  RecordProperty("kabsch_held_out_mm", std::to_string(kabsch * 1e3));
}

}  // namespace
}  // namespace sextant
