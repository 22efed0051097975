// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/make_solver.h"
#include "support/outliers.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::AddOutliers;
using test::MakeScene;
using test::MakeSolver;
using test::PairScene;
using test::SceneOptions;

std::vector<Pair3d3d> ReadPoints(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::size_t count = 0;
  file >> count;
  std::vector<Pair3d3d> pairs(count);
  for (Pair3d3d& pair : pairs) {
    for (int k = 0; k < 3; ++k) file >> pair.point_in_lidar[k];
  }
  for (Pair3d3d& pair : pairs) {
    for (int k = 0; k < 3; ++k) file >> pair.point_in_cam[k];
  }
  return pairs;
}

TEST(Refine, AgreesWithKabschOnRealData) {
  SEXTANT_REAL_DATA(path, "dhall/points_head.txt");
  CalibrationProblem problem;
  problem.pairs_3d3d = ReadPoints(path);
  const Expected<SolveReport> kabsch = MakeSolver("kabsch")->Solve(problem);
  ASSERT_TRUE(kabsch);
  for (const char* spec : {"refine(kabsch)", "refine(mean_offset)",
                           "refine(kabsch,loss=barron,"
                           "loss_shape=2)"}) {
    const Expected<SolveReport> refined = MakeSolver(spec)->Solve(problem);
    ASSERT_TRUE(refined) << spec << ": " << refined.error().message;
    const PoseDistance distance = DistanceBetween(refined->cam_from_lidar, kabsch->cam_from_lidar);
    EXPECT_LT(distance.rotation_rad, 1e-9) << spec;
    EXPECT_LT(distance.translation_m, 1e-9) << spec;
    EXPECT_NEAR(*refined->evaluation.rmse_m, 0.03914974, 1e-7) << spec;
    EXPECT_EQ(refined->termination, Termination::kConverged);
    ASSERT_EQ(refined->stages.size(), 1U);
    EXPECT_EQ(refined->inliers.size(), 8U);
  }
}

// Both kinds together must be more accurate than each alone: RMS over 200 scenes, whose standard
// error of about 3 percent is far below the difference.
TEST(Refine, BothKindsTogetherAreMorePreciseThanEither) {
  const auto rms_error = [](const std::string& on) {
    double sum = 0.0;
    const SolverPtr solver = MakeSolver("refine(kabsch,on=" + on + ")");
    for (std::uint64_t trial = 0; trial < 200; ++trial) {
      Random random(DeriveSeed(1, "refine both", 0, trial));
      const PairScene scene = MakeScene({.pairs = 10, .sigma_m = 0.01, .sigma_px = 2.0}, random);
      const Expected<SolveReport> report = solver->Solve(scene.problem);
      EXPECT_TRUE(report) << report.error().message;
      const double error =
          DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).translation_m;
      sum += error * error / 200.0;
    }
    return std::sqrt(sum);
  };
  const double both = rms_error("both");
  EXPECT_LT(both, 0.9 * rms_error("3d3d"));
  EXPECT_LT(both, 0.9 * rms_error("2d3d"));
}

// Redescending losses have no gradient far away, so they start from huber's answer.
TEST(Refine, LossesResistOutliersThatLeastSquaresFollows) {
  const SceneOptions options{.pairs = 40, .sigma_m = 0.005};
  const std::string huber = "refine(kabsch,loss=huber,max_iterations=1000)";
  const std::string specs[] = {huber, "refine(" + huber + ",loss=cauchy,max_iterations=1000)",
                               "refine(" + huber + ",loss=tukey,max_iterations=1000)",
                               "refine(" + huber + ",loss=barron,max_iterations=1000)"};
  double plain = 0.0;
  double robust[4] = {};
  for (std::uint64_t trial = 0; trial < 20; ++trial) {
    Random random(DeriveSeed(2, "refine losses", 0, trial));
    PairScene scene = MakeScene(options, random);
    AddOutliers(0.1, options, random, scene);
    const auto error = [&](const std::string& spec) {
      const Expected<SolveReport> report = MakeSolver(spec)->Solve(scene.problem);
      EXPECT_TRUE(report) << spec << ": " << report.error().message;
      return report ? DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).translation_m
                    : 1.0;
    };
    plain += error("refine(kabsch)");
    for (std::size_t i = 0; i < 4; ++i) robust[i] += error(specs[i]);
  }
  for (std::size_t i = 0; i < 4; ++i) EXPECT_LT(robust[i], 0.3 * plain) << specs[i];
}

TEST(Refine, UsesTheInliersOfTheInnerSolver) {
  Random random(3);
  const SceneOptions options{.pairs = 30, .sigma_m = 0.01};
  PairScene scene = MakeScene(options, random);
  const std::vector<int> inliers = AddOutliers(0.4, options, random, scene);
  const Expected<SolveReport> inner = MakeSolver("ransac(kabsch)")->Solve(scene.problem);
  const Expected<SolveReport> refined = MakeSolver("refine(ransac(kabsch))")->Solve(scene.problem);
  ASSERT_TRUE(inner && refined);
  EXPECT_EQ(refined->inliers, inner->inliers);
  ASSERT_EQ(refined->stages.size(), 2U);
  EXPECT_EQ(refined->stages[0].solver, "kabsch");
  EXPECT_EQ(refined->stages[1].solver, "ransac(kabsch)");
  EXPECT_LT(DistanceBetween(refined->cam_from_lidar, inner->cam_from_lidar).translation_m, 1e-8);
}

TEST(Refine, DropsTheSameCornersOfBothKinds) {
  Random random(6);
  const SceneOptions options{.pairs = 30, .sigma_m = 0.01, .sigma_px = 1.0};
  PairScene scene = MakeScene(options, random);
  const std::vector<int> inliers = AddOutliers(0.4, options, random, scene);
  for (const char* inner : {"ransac(kabsch)", "ransac(p3p)", "refine(ransac(p3p),on=both)"}) {
    const std::string spec = std::string("refine(") + inner + ",on=both)";
    const Expected<SolveReport> report = MakeSolver(spec)->Solve(scene.problem);
    ASSERT_TRUE(report) << spec << ": " << report.error().message;
    EXPECT_LT(DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).translation_m, 0.03);
    EXPECT_GT(report->inliers.size() + 3, inliers.size()) << spec;
    EXPECT_TRUE(std::includes(inliers.begin(), inliers.end(), report->inliers.begin(),
                              report->inliers.end()))
        << spec;
  }
}

TEST(Refine, ReportsWhenItDoesNotConverge) {
  Random random(4);
  const PairScene scene = MakeScene({.pairs = 10, .sigma_m = 0.05}, random);
  const Expected<SolveReport> report =
      MakeSolver("refine(mean_offset,max_iterations=2)")->Solve(scene.problem);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kNoConvergence);
}

TEST(Refine, RefusesUnsuitableData) {
  const SolverRegistry registry = BuiltinSolvers();
  EXPECT_EQ(registry.Make("refine(icp)").error().code, ErrorCode::kInvalidOption);
  EXPECT_TRUE(registry.Make("refine(icp,on=3d3d)"));
  EXPECT_EQ(registry.Make("ransac(icp)").error().code, ErrorCode::kInvalidOption);
  EXPECT_EQ(registry.Make("gnc(refine(kabsch,on=both))").error().code, ErrorCode::kInvalidOption);
  EXPECT_EQ(registry.Make("refine(kabsch,loss=hubert)").error().code, ErrorCode::kInvalidOption);
  Random random(5);
  PairScene scene = MakeScene({.pairs = 10}, random);
  scene.problem.pairs_2d3d.clear();
  const Expected<SolveReport> report = MakeSolver("refine(kabsch,on=both)")->Solve(scene.problem);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kMissingData);
}

}  // namespace
}  // namespace sextant
