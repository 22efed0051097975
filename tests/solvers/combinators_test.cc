// SPDX-License-Identifier: Apache-2.0
// Properties of each robust solver; outliers_test.cc has those that all share.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/outliers.h"

namespace sextant {
namespace {

using test::AddOutliers;
using test::MakeScene;
using test::PairScene;
using test::SceneOptions;

Expected<SolveReport> Solve(const std::string& spec, const CalibrationProblem& problem) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(spec);
  if (!solver) return tl::unexpected<Error>(solver.error());
  return (*solver)->Solve(problem);
}

PairScene SceneWithOutliers(std::uint64_t seed, int pairs, double share) {
  Random random(seed);
  const SceneOptions options{.pairs = pairs, .sigma_m = 0.01, .sigma_px = 1.0};
  PairScene scene = MakeScene(options, random);
  AddOutliers(share, options, random, scene);
  return scene;
}

TEST(Ransac, AnotherSeedFindsTheSamePose) {
  const PairScene scene = SceneWithOutliers(1, 40, 0.5);
  const Expected<SolveReport> first = Solve("ransac(kabsch,seed=1)", scene.problem);
  const Expected<SolveReport> again = Solve("ransac(kabsch,seed=1)", scene.problem);
  const Expected<SolveReport> other = Solve("ransac(kabsch,seed=2)", scene.problem);
  ASSERT_TRUE(first && again && other);
  EXPECT_EQ(first->cam_from_lidar.translation, again->cam_from_lidar.translation);
  EXPECT_EQ(first->inliers, other->inliers);
  EXPECT_LT(DistanceBetween(first->cam_from_lidar, other->cam_from_lidar).translation_m, 1e-9);
}

TEST(Ransac, StopsEarlyOnCleanDataAndAtItsLimitOnPoor) {
  const Expected<SolveReport> clean =
      Solve("ransac(kabsch)", SceneWithOutliers(2, 40, 0.0).problem);
  ASSERT_TRUE(clean);
  EXPECT_LE(clean->iterations, 3);
  EXPECT_EQ(clean->termination, Termination::kConverged);
  const Expected<SolveReport> poor =
      Solve("ransac(kabsch,max_iterations=300)", SceneWithOutliers(3, 40, 0.7).problem);
  ASSERT_TRUE(poor);
  EXPECT_EQ(poor->iterations, 300);
  EXPECT_EQ(poor->termination, Termination::kMaxIterations);
}

TEST(Ransac, RefusesSamplesThatAreTooLargeOrTooSmall) {
  const PairScene scene = SceneWithOutliers(4, 10, 0.0);
  const Expected<SolveReport> large = Solve("ransac(kabsch,sample_size=15)", scene.problem);
  ASSERT_FALSE(large);
  EXPECT_EQ(large.error().code, ErrorCode::kTooFewPairs);
  const Expected<SolveReport> small = Solve("ransac(kabsch,sample_size=2)", scene.problem);
  ASSERT_FALSE(small);
  EXPECT_EQ(small.error().code, ErrorCode::kInvalidOption);
}

TEST(Ransac, ObeysThresholdAndMinInliers) {
  const PairScene scene = SceneWithOutliers(5, 30, 0.3);
  const Expected<SolveReport> strict = Solve("ransac(kabsch,min_inliers=25)", scene.problem);
  ASSERT_FALSE(strict);
  EXPECT_EQ(strict.error().code, ErrorCode::kNoConsensus);
  const Expected<SolveReport> report = Solve("ransac(kabsch,threshold=2)", scene.problem);
  ASSERT_TRUE(report);
  EXPECT_LT(report->inliers.size(), 21U);
  for (const int i : report->inliers) {
    EXPECT_LE(report->evaluation.per_pair_m[static_cast<std::size_t>(i)], 2.0 * 0.01 + 1e-9);
  }
}

TEST(Ransac, CountsAPairGivenSeveralTimesOnce) {
  PairScene scene = SceneWithOutliers(12, 21, 0.0);
  for (std::size_t i = 3; i < 21; ++i) {
    scene.problem.pairs_3d3d[i] = scene.problem.pairs_3d3d[i % 3];
    scene.problem.pairs_2d3d[i] = scene.problem.pairs_2d3d[i % 3];
  }
  for (const char* spec : {"ransac(kabsch)", "ransac(p3p)", "gnc(kabsch)", "drop_worst(p3p)"}) {
    const Expected<SolveReport> report = Solve(spec, scene.problem);
    ASSERT_FALSE(report) << spec;
    EXPECT_EQ(report.error().code, ErrorCode::kNoConsensus) << spec;
  }
}

TEST(Ransac, ReportsMirroredPoints) {
  PairScene scene = SceneWithOutliers(13, 20, 0.0);
  for (Pair3d3d& pair : scene.problem.pairs_3d3d) pair.point_in_lidar.x() *= -1.0;
  for (const char* spec : {"ransac(kabsch)", "gnc(kabsch)", "clique(kabsch)", "robust(kabsch)"}) {
    const Expected<SolveReport> report = Solve(spec, scene.problem);
    ASSERT_FALSE(report) << spec;
    EXPECT_EQ(report.error().code, ErrorCode::kMirrored) << spec;
  }
}

TEST(Ransac, WithoutRefitReturnsTheBestSample) {
  const PairScene scene = SceneWithOutliers(6, 30, 0.3);
  const Expected<SolveReport> report =
      Solve("ransac(kabsch,refit=none,local_optimisation=0)", scene.problem);
  ASSERT_TRUE(report);
  EXPECT_TRUE(report->stages.empty());
  EXPECT_TRUE(report->covariance);
}

TEST(DropWorst, KeepsTheGivenNumberAndDropsOutliersFirst) {
  Random random(7);
  const SceneOptions options{.pairs = 20, .sigma_m = 0.01};
  PairScene scene = MakeScene(options, random);
  const std::vector<int> inliers = AddOutliers(0.2, options, random, scene);
  for (const std::size_t keep : {16U, 11U, 8U}) {
    const Expected<SolveReport> report =
        Solve("drop_worst(kabsch,keep=" + std::to_string(keep) + ")", scene.problem);
    ASSERT_TRUE(report);
    EXPECT_EQ(report->inliers.size(), keep);
    EXPECT_EQ(report->iterations, static_cast<int>(20 - keep) + 1);
    EXPECT_TRUE(std::includes(inliers.begin(), inliers.end(), report->inliers.begin(),
                              report->inliers.end()));
  }
  EXPECT_EQ(Solve("drop_worst(kabsch,keep=2)", scene.problem).error().code,
            ErrorCode::kInvalidOption);
  EXPECT_EQ(Solve("drop_worst(kabsch,keep=21)", scene.problem).error().code,
            ErrorCode::kTooFewPairs);
}

TEST(DropWorst, ManyPairsTakeFewSolutions) {
  Random random(8);
  const SceneOptions options{.pairs = 10'000, .sigma_m = 0.01};
  PairScene scene = MakeScene(options, random);
  AddOutliers(0.2, options, random, scene);
  const Expected<SolveReport> report = Solve("drop_worst(kabsch,keep=20)", scene.problem);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->inliers.size(), 20U);
  EXPECT_TRUE(std::ranges::is_sorted(report->inliers));
  EXPECT_LT(report->iterations, 700);
  const Expected<SolveReport> within = Solve("drop_worst(kabsch)", scene.problem);
  ASSERT_TRUE(within) << within.error().message;
  EXPECT_LT(within->iterations, 100);
  EXPECT_LT(DistanceBetween(within->cam_from_lidar, scene.cam_from_lidar).translation_m, 0.003);
}

// Points in one frame twice: every residual is zero.
TEST(ExactPairs, HaveSigmasOfRoundingAndSayIt) {
  Random random(9);
  CalibrationProblem problem;
  for (int i = 0; i < 20; ++i) {
    Pair3d3d pair;
    for (int axis = 0; axis < 3; ++axis) pair.point_in_cam[axis] = random.Uniform(-5.0, 5.0);
    pair.point_in_lidar = pair.point_in_cam;
    problem.pairs_3d3d.push_back(pair);
  }
  for (const char* spec : {"kabsch", "ransac(kabsch)", "gnc(kabsch)", "drop_worst(kabsch)"}) {
    const Expected<SolveReport> report = Solve(spec, problem);
    ASSERT_TRUE(report && report->covariance && report->noise) << spec;
    const Vector6d sigmas = report->covariance->diagonal().cwiseSqrt();
    EXPECT_GT(sigmas.minCoeff(), 1e-14) << spec;
    EXPECT_LT(sigmas.maxCoeff(), 1e-9) << spec;
    EXPECT_GT(*report->noise->sigma_m, 0.0) << spec;
    const auto is_said = [](const std::string& warning) {
      return warning.find("to the last digit") != std::string::npos;
    };
    EXPECT_TRUE(std::ranges::any_of(report->warnings, is_said)) << spec;
  }
}

TEST(Gnc, LeavesCleanDataAlone) {
  const PairScene scene = SceneWithOutliers(8, 8, 0.0);
  const Expected<SolveReport> plain = Solve("kabsch", scene.problem);
  const Expected<SolveReport> gnc = Solve("gnc(kabsch,threshold=6)", scene.problem);
  ASSERT_TRUE(plain && gnc);
  EXPECT_EQ(gnc->inliers.size(), 8U);
  EXPECT_EQ(gnc->iterations, 1);
  EXPECT_EQ(gnc->cam_from_lidar.translation, plain->cam_from_lidar.translation);
}

// Isotropic pairs use columns and closed forms, pairs with covariances iterate over terms.
TEST(IsotropicPairs, ColumnsAndCovariancesGiveTheSameAnswer) {
  for (const char* spec : {"gnc(kabsch)", "ransac(kabsch)", "ransac(kabsch,refit=none)",
                           "ransac(kabsch,local_optimisation=0)"}) {
    for (const int pairs : {12, 64, 100}) {
      for (const double share : {0.0, 0.2, 0.5}) {
        PairScene scene = SceneWithOutliers(static_cast<std::uint64_t>(pairs), pairs, share);
        const Expected<SolveReport> in_columns = Solve(spec, scene.problem);
        for (Pair3d3d& pair : scene.problem.pairs_3d3d) {
          pair.covariance_in_cam = pair.sigma_m * pair.sigma_m * Eigen::Matrix3d::Identity();
        }
        const Expected<SolveReport> by_covariances = Solve(spec, scene.problem);
        ASSERT_TRUE(in_columns && by_covariances) << spec << ", " << pairs << " pairs, " << share;
        EXPECT_EQ(in_columns->inliers, by_covariances->inliers);
        EXPECT_EQ(in_columns->iterations, by_covariances->iterations);
        const PoseDistance apart =
            DistanceBetween(in_columns->cam_from_lidar, by_covariances->cam_from_lidar);
        EXPECT_LT(apart.rotation_rad, 1e-9) << spec << ", " << pairs << " pairs, " << share;
        EXPECT_LT(apart.translation_m, 1e-9) << spec << pairs << share;
      }
    }
  }
}

TEST(CliqueSolver, StaysWithinItsNodesOnAThousandPairs) {
  for (const double share : {0.0, 0.5}) {
    const PairScene scene = SceneWithOutliers(10, 1000, share);
    const Expected<SolveReport> report = Solve("clique(kabsch,max_nodes=2000)", scene.problem);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_LE(report->iterations, 2000);
    EXPECT_LT(DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).translation_m, 0.005);
  }
}

}  // namespace
}  // namespace sextant
