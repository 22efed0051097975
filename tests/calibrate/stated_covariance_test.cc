// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/stated_covariance.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "calibrate/trust/trust.h"
#include "geometry/random_vectors.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant {
namespace {

constexpr double kPairSigma = 0.01;
const Rigid3d kTruePose = {ExpSo3({1.2, -1.2, 1.2}), {0.1, -0.2, -0.1}};

Matrix6d RandomCovariance(Random& random) {
  Matrix6d root;
  for (int i = 0; i < 36; ++i) root(i) = random.Normal();
  const Vector6d units = (Vector6d() << 1e-3, 1e-3, 1e-3, 0.1, 0.1, 0.1).finished();
  return units.asDiagonal() * (root * root.transpose() + 0.1 * Matrix6d::Identity()) *
         units.asDiagonal();
}

// The smallest eigenvalue of a relative to b: above 1 where a exceeds b in every direction.
double SmallestRatio(const Matrix6d& a, const Matrix6d& b) {
  const Vector6d scale = b.diagonal().cwiseSqrt().cwiseInverse();
  const SymmetricEigen<6> eigen = EigenOf<6>(scale.asDiagonal() * (a - b) * scale.asDiagonal());
  return 1.0 + eigen.values[0];
}

TEST(StatedCovariance, NoDirectionIsBelowTheSolversOrTheBootstraps) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Matrix6d solver = RandomCovariance(random);
    const Matrix6d bootstrap = RandomCovariance(random);
    const auto stated = StatedCovariance(
        solver, {.views = 8, .jackknife_over_solver = 0.5, .bootstrap = bootstrap});
    ASSERT_TRUE(stated);
    EXPECT_GT(SmallestRatio(*stated, solver), 1.0 - 1e-9);
    EXPECT_GT(SmallestRatio(*stated, bootstrap), 1.0 - 1e-9);
  }
}

TEST(StatedCovariance, IsTheSolversWhereTheViewsShowNoMore) {
  Random random(2);
  const Matrix6d solver = RandomCovariance(random);
  const auto same = StatedCovariance(
      solver, {.views = 20, .jackknife_over_solver = 0.9, .bootstrap = Matrix6d(0.5 * solver)});
  EXPECT_LT((*same - solver).norm(), 1e-9 * solver.norm());
  const auto twice = StatedCovariance(solver, {.views = 1000, .jackknife_over_solver = 2.0});
  EXPECT_NEAR((*twice)(3, 3) / solver(3, 3), 4.0, 0.01);
  const auto few = StatedCovariance(solver, {.views = 2, .jackknife_over_solver = 2.0});
  EXPECT_NEAR((*few)(3, 3) / solver(3, 3), 4.0 * 1.837 * 1.837, 0.01);
  EXPECT_FALSE(StatedCovariance({}, {.views = 3}));
  EXPECT_TRUE(StatedCovariance({}, {.views = 3, .bootstrap = solver}));
}

TEST(StatedCovariance, TIsThatOfTheTables) {
  EXPECT_NEAR(OneSigmaOfT(1), 1.837, 0.002);
  EXPECT_NEAR(OneSigmaOfT(5), 1.111, 0.002);
  EXPECT_NEAR(OneSigmaOfT(9), 1.059, 0.002);
  EXPECT_NEAR(OneSigmaOfT(19), 1.027, 0.002);
  EXPECT_EQ(OneSigmaOfT(0), OneSigmaOfT(1));
}

TEST(StatedCovariance, CongruenceMapsOneMatrixToTheOther) {
  Random random(3);
  const Matrix6d from = RandomCovariance(random).inverse();
  const Matrix6d to = RandomCovariance(random).inverse();
  const auto map = CongruenceTo(from, to);
  ASSERT_TRUE(map);
  EXPECT_LT((*map * from * *map - to).norm(), 1e-8 * to.norm());
  EXPECT_FALSE(CongruenceTo(Matrix6d::Zero(), to));
}

// Each view has an error of its own of `common`, which its pairs do not state.
double MeanNees(int views, double common) {
  constexpr int kSessions = 150;
  const SolverPtr solver = *BuiltinSolvers().Make("kabsch");
  double nees = 0.0;
  for (int session = 0; session < kSessions; ++session) {
    const auto seed = static_cast<std::uint64_t>(session);
    Random random(DeriveSeed(7, "stated covariance", static_cast<std::uint64_t>(views), seed));
    CalibrationProblem problem;
    for (int view = 0; view < views; ++view) {
      const Eigen::Vector3d place = Eigen::Vector3d(2.5, 0.0, 0.0) + 0.7 * NormalVector(random);
      const Eigen::Vector3d shift = common * NormalVector(random);
      for (int corner = 0; corner < 4; ++corner) {
        Pair3d3d pair;
        pair.id = {.view = view, .board = 0, .corner = corner};
        pair.point_in_lidar = place + 0.4 * NormalVector(random);
        pair.point_in_cam =
            kTruePose * pair.point_in_lidar + shift + kPairSigma * NormalVector(random);
        pair.sigma_m = kPairSigma;
        problem.pairs_3d3d.push_back(pair);
      }
    }
    const Expected<SolveReport> answer = solver->Solve(problem);
    const Expected<Trust> trust =
        AssessTrust(problem, *solver, *answer, {.bootstrap_samples = 60, .seed = seed});
    const Vector6d error = PoseDifference(kTruePose, answer->cam_from_lidar);
    nees += SquaredMahalanobis<6>(error, *trust->covariance) / 6.0 / kSessions;
  }
  return nees;
}

// The solver's alone would have 1, and 9 to 17 with the unstated errors.
TEST(StatedCovariance, IsHonestWhetherOrNotTheNoiseIsAsStated) {
  for (const int views : {4, 6, 20}) {
    for (const double common : {0.0, 0.02}) {
      const double nees = MeanNees(views, common);
      RecordProperty("nees_" + std::to_string(views) + (common > 0.0 ? "_more" : "_as_stated"),
                     std::to_string(nees));
      EXPECT_LT(nees, 1.35) << views << " views, " << common;
      EXPECT_GT(nees, 0.4) << views << " views, " << common;
      std::printf("views %d common %.3f nees %.2f\n", views, common, nees);
    }
  }
}

}  // namespace
}  // namespace sextant
