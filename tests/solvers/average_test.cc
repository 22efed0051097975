// SPDX-License-Identifier: Apache-2.0
#include "solvers/averaging/average.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/poses.h"

namespace sextant {
namespace {

using test::ExpectSamePose;

struct AveragedSession {
  CalibrationProblem problem;
  Rigid3d cam_from_lidar;
};

// Eight points per view; the views alternate from pair to pair, as the order of pairs is arbitrary.
AveragedSession MakeAveragedSession(int views, double sigma_m, Random& random) {
  AveragedSession session;
  session.cam_from_lidar = {ExpSo3(NormalVector(random)), NormalVector(random)};
  for (int i = 0; i < 8 * views; ++i) {
    Pair3d3d pair;
    pair.point_in_lidar = NormalVector(random);
    pair.point_in_cam =
        session.cam_from_lidar * pair.point_in_lidar + sigma_m * NormalVector(random);
    pair.id.view = 10 * (i % views);
    session.problem.pairs_3d3d.push_back(pair);
  }
  return session;
}

Expected<SolveReport> SolveWith(const char* spec, const CalibrationProblem& problem) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(spec);
  if (!solver) return tl::unexpected<Error>(solver.error());
  return (*solver)->Solve(problem);
}

TEST(Average, AveragesTheAnswersOfTheViews) {
  Random random(1);
  const AveragedSession session = MakeAveragedSession(4, 0.01, random);
  std::vector<Rigid3d> poses;
  for (int view = 0; view < 40; view += 10) {
    CalibrationProblem one = session.problem;
    std::erase_if(one.pairs_3d3d, [view](const Pair3d3d& p) { return p.id.view != view; });
    poses.push_back(SolveWith("kabsch", one)->cam_from_lidar);
  }
  const std::pair<const char*, RotationAverage> kinds[] = {
      {"average(kabsch)", RotationAverage::kChordal},
      {"average(kabsch,rotation=quaternion_sum)", RotationAverage::kQuaternionSum},
      {"average(kabsch,rotation=original_running)", RotationAverage::kOriginalRunning}};
  for (const auto& [spec, kind] : kinds) {
    const Expected<SolveReport> report = SolveWith(spec, session.problem);
    ASSERT_TRUE(report) << report.error().message;
    ExpectSamePose(report->cam_from_lidar, *AveragePoses(poses, kind), 1e-12);
    EXPECT_EQ(report->inliers.size(), 32U);
    ASSERT_EQ(report->stages.size(), 4U);
    EXPECT_EQ(report->stages[2].solver, "kabsch on view 20");
    ExpectSamePose(report->stages[2].cam_from_lidar, poses[2], 1e-12);
  }
}

TEST(Average, OfOneViewIsTheInnerSolver) {
  Random random(2);
  const AveragedSession session = MakeAveragedSession(1, 0.01, random);
  const Expected<SolveReport> average = SolveWith("average(kabsch)", session.problem);
  const Expected<SolveReport> kabsch = SolveWith("kabsch", session.problem);
  ASSERT_TRUE(average && kabsch);
  ExpectSamePose(average->cam_from_lidar, kabsch->cam_from_lidar, 1e-14);
  EXPECT_TRUE(average->covariance->isApprox(*kabsch->covariance, 1e-12));
}

TEST(Average, LeavesOutViewsThatFail) {
  Random random(3);
  AveragedSession session = MakeAveragedSession(3, 0.0, random);
  for (Pair3d3d& pair : session.problem.pairs_3d3d) {
    if (pair.id.view == 10) pair.point_in_lidar = pair.point_in_cam = {1.0, 2.0, 3.0};
  }
  const Expected<SolveReport> report = SolveWith("average(kabsch)", session.problem);
  ASSERT_TRUE(report) << report.error().message;
  ExpectSamePose(report->cam_from_lidar, session.cam_from_lidar, 1e-12);
  EXPECT_EQ(report->stages.size(), 2U);
  EXPECT_EQ(report->inliers.size(), 16U);
  for (const int i : report->inliers) EXPECT_NE(i % 3, 1);
}

TEST(Average, NamesEveryViewWhereNoneCanBeSolved) {
  Random random(4);
  AveragedSession session = MakeAveragedSession(2, 0.0, random);
  for (Pair3d3d& pair : session.problem.pairs_3d3d) pair.point_in_lidar.setZero();
  const Expected<SolveReport> report = SolveWith("average(kabsch)", session.problem);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kDegenerate);
  EXPECT_NE(report.error().message.find("view 0:"), std::string::npos);
  EXPECT_NE(report.error().message.find("view 10:"), std::string::npos);
}

TEST(Average, RefusesSolversOfDataWithoutViews) {
  EXPECT_EQ(BuiltinSolvers().Make("average(icp)").error().code, ErrorCode::kInvalidOption);
}

// Hotelling's T^2 of n views in p dimensions has the mean p (n - 1) / (n - p - 2); the tolerance is
// five empirical standard errors of the mean.
TEST(Average, StandardErrorFromTheScatterIsConsistent) {
  constexpr int kTrials = 300;
  constexpr int kViews = 20;
  for (const char* spec : {"average(kabsch)", "average(kabsch,rotation=original_running)"}) {
    Vector6d variance = Vector6d::Zero();
    Vector6d squares = Vector6d::Zero();
    double sum = 0.0;
    double sum_squares = 0.0;
    for (int trial = 0; trial < kTrials; ++trial) {
      Random random(DeriveSeed(5, "average", 0, static_cast<std::uint64_t>(trial)));
      const AveragedSession session = MakeAveragedSession(kViews, 0.005, random);
      const Expected<SolveReport> report = SolveWith(spec, session.problem);
      ASSERT_TRUE(report && report->covariance);
      const Vector6d error = PoseDifference(report->cam_from_lidar, session.cam_from_lidar);
      squares += error.cwiseAbs2() / kTrials;
      variance += report->covariance->diagonal() / kTrials;
      const double t2 = SquaredMahalanobis(error, *report->covariance);
      sum += t2;
      sum_squares += t2 * t2;
    }
    // A variance from 300 errors of heavier than normal tails has a standard error of about a
    // tenth.
    for (int i = 0; i < 6; ++i) EXPECT_NEAR(squares[i] / variance[i], 1.0, 0.5) << spec;
    if (std::string(spec) != "average(kabsch)") continue;
    const double mean = sum / kTrials;
    const double error = std::sqrt((sum_squares / kTrials - mean * mean) / kTrials);
    EXPECT_NEAR(mean, 6.0 * (kViews - 1) / (kViews - 8.0), 5.0 * error);
  }
}

TEST(Average, FewViewsGiveVariancesAndTwoPropagate) {
  Random random(6);
  const Expected<SolveReport> five =
      SolveWith("average(kabsch)", MakeAveragedSession(5, 0.01, random).problem);
  ASSERT_TRUE(five && five->covariance);
  EXPECT_TRUE(five->covariance->isDiagonal(0.0));
  EXPECT_GT(five->covariance->diagonal().minCoeff(), 0.0);

  const Matrix6d one = Matrix6d::Identity() * 4.0;
  const std::vector<std::optional<Matrix6d>> both = {one, 2.0 * one};
  const std::vector<Rigid3d> poses(2);
  const auto covariance =
      AverageCovariance(poses, both, Rigid3d{}, RotationAverage::kOriginalRunning);
  ASSERT_TRUE(covariance);
  EXPECT_TRUE(covariance->isApprox(Matrix6d::Identity() * 3.0, 1e-15));
  const std::vector<std::optional<Matrix6d>> unknown = {one, std::nullopt};
  EXPECT_FALSE(AverageCovariance(poses, unknown, Rigid3d{}, RotationAverage::kChordal));
}

}  // namespace
}  // namespace sextant
