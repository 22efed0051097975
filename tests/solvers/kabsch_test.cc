// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/kabsch.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/pair_noise.h"
#include "geometry/so3.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/points.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::MakeScene;
using test::Moved;
using test::NormalPoints;
using test::PairScene;
using Points = std::vector<Eigen::Vector3d>;

TEST(Kabsch, RecoversExactPosesFarFromTheOrigin) {
  Random random(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Rigid3d truth{ExpSo3({random.Normal(), random.Normal(), random.Normal()}),
                        {100.0, -200.0, 300.0}};
    const Points a = NormalPoints(3 + trial % 20, random);
    const Expected<KabschFit> fit = FitKabsch(Moved(truth, a), a);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_LT(RotationDistance(fit->b_from_a.rotation, truth.rotation), 1e-8);
    EXPECT_LT((fit->b_from_a.translation - truth.translation).norm(), 1e-8);
  }
}

TEST(Kabsch, RecoversExactPosesOfEveryShapeAndScale) {
  Random random(4);
  for (const double scale_m : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
    for (const double flatness : {0.0, 1e-3, 0.3, 1.0}) {
      for (int trial = 0; trial < 40; ++trial) {
        const Rigid3d truth{ExpSo3({random.Normal(), random.Normal(), random.Normal()}),
                            scale_m * Eigen::Vector3d(1, -2, 3)};
        Points a = NormalPoints(4 + trial % 20, random);
        for (Eigen::Vector3d& p : a) p = scale_m * p.cwiseProduct(Eigen::Vector3d(1, 1, flatness));
        const Expected<KabschFit> fit = FitKabsch(Moved(truth, a), a);
        ASSERT_TRUE(fit) << fit.error().message;
        EXPECT_LT(RotationDistance(fit->b_from_a.rotation, truth.rotation), 1e-12);
        EXPECT_LT((fit->b_from_a.translation - truth.translation).norm(), 2e-12 * scale_m);
      }
    }
  }
}

// No more precision may be lost than by rounding the coordinates at 1 km.
TEST(Kabsch, IsPreciseAKilometreFromBothOrigins) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const Rigid3d truth{ExpSo3({random.Normal(), random.Normal(), random.Normal()}),
                        {1000.0, 2000.0, -1000.0}};
    Points a = NormalPoints(8, random);
    for (Eigen::Vector3d& p : a) p += Eigen::Vector3d(1000.0, -1000.0, 1000.0);
    const Expected<KabschFit> fit = FitKabsch(Moved(truth, a), a);
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_LT(RotationDistance(fit->b_from_a.rotation, truth.rotation), 2e-11);
    EXPECT_LT((*fit).sum_squares, 1e-13 * 48.0);
  }
}

// The sums of squares are those of the residuals, of the rotation and of the best reflection.
TEST(Kabsch, ReportsTheSumsOfSquaresOfBothKinds) {
  Random random(6);
  for (int trial = 0; trial < 300; ++trial) {
    const Points a = NormalPoints(3 + trial % 12, random);
    Points b = a;
    for (Eigen::Vector3d& p : b) {
      for (int k = 0; k < 3; ++k) p[k] += 0.3 * random.Normal();
    }
    const Expected<KabschFit> fit = FitKabsch(b, a);
    ASSERT_TRUE(fit) << fit.error().message;
    double sum = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += (b[i] - fit->b_from_a * a[i]).squaredNorm();
    EXPECT_NEAR(fit->sum_squares, sum, 1e-12 * static_cast<double>(a.size()));

    Points inverted = a;
    for (Eigen::Vector3d& p : inverted) p = -p;
    const Expected<KabschFit> mirrored = FitKabsch(b, inverted);
    if (!mirrored) continue;
    EXPECT_NEAR(fit->mirrored_sum_squares, mirrored->sum_squares,
                1e-6 * static_cast<double>(a.size()));
  }
}

// The closed form of the covariance is that of the implicit function theorem pair by pair, also
// with noise that the residuals give.
TEST(Kabsch, StatesTheCovarianceOfThePropagation) {
  Random random(8);
  const SolverPtr solver = *BuiltinSolvers().Make("kabsch");
  for (const int pairs : {3, 4, 8, 13, 100}) {
    for (const bool known : {true, false}) {
      PairScene scene = MakeScene({.pairs = pairs, .sigma_m = 0.05}, random);
      for (Pair3d3d& pair : scene.problem.pairs_3d3d) {
        pair.sigma_m = known ? 0.05 * random.Uniform(0.5, 2.0) : 0.0;
        pair.id = {};  // On no board, so that no errors in common are looked for.
      }
      const Expected<SolveReport> report = solver->Solve(scene.problem);
      ASSERT_TRUE(report) << report.error().message;
      const auto propagated =
          PropagateCovariance(scene.problem.pairs_3d3d, IsotropicWeights(scene.problem.pairs_3d3d),
                              report->cam_from_lidar);
      ASSERT_TRUE(report->covariance && propagated);
      EXPECT_TRUE(report->covariance->isApprox(*propagated, 1e-9)) << pairs << " pairs";
    }
  }
}

TEST(Kabsch, RefusesCollinearCoincidentAndMirroredSets) {
  Random random(2);
  const Points a = NormalPoints(8, random);
  Points line = a;
  for (Eigen::Vector3d& p : line) p = Eigen::Vector3d(1, 2, 3) + p.x() * Eigen::Vector3d(1, 1, 0);
  EXPECT_EQ(FitKabsch(a, line).error().code, ErrorCode::kDegenerate);
  EXPECT_EQ(FitKabsch(line, a).error().code, ErrorCode::kDegenerate);
  const Points same(8, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(FitKabsch(same, a).error().code, ErrorCode::kDegenerate);
  Points mirrored = a;
  for (Eigen::Vector3d& p : mirrored) p.x() = -p.x();
  EXPECT_EQ(FitKabsch(mirrored, a).error().code, ErrorCode::kMirrored);
  EXPECT_EQ(
      FitKabsch(Points(a.begin(), a.begin() + 2), Points(a.begin(), a.begin() + 2)).error().code,
      ErrorCode::kTooFewPairs);
}

TEST(Kabsch, HypothesizesFromSamplesOfEverySize) {
  Random random(7);
  const PairScene scene = MakeScene({.pairs = 200}, random);
  const SolverPtr solver = *BuiltinSolvers().Make("kabsch");
  std::vector<Rigid3d> poses;
  for (const int size : {3, 64, 65, 200}) {
    std::vector<int> sample(static_cast<std::size_t>(size));
    random.Sample(200, sample);
    poses.clear();
    solver->Hypothesize(scene.problem, sample, poses);
    ASSERT_EQ(poses.size(), 1u) << size;
    EXPECT_LT(RotationDistance(poses[0].rotation, scene.cam_from_lidar.rotation), 1e-8) << size;
  }
  solver->Hypothesize(scene.problem, std::vector<int>{4, 4, 4, 4}, poses);
  EXPECT_EQ(poses.size(), 1u) << "a degenerate sample gives no pose";
}

TEST(Kabsch, WeightsCountAsRepetitions) {
  Random random(3);
  Points a = NormalPoints(6, random);
  Points b = NormalPoints(6, random);
  const std::vector<double> weights = {1, 1, 2, 1, 3, 1};
  const Expected<KabschFit> weighted = FitKabsch(b, a, weights);
  for (const int i : {2, 4, 4}) {
    a.push_back(a[static_cast<std::size_t>(i)]);
    b.push_back(b[static_cast<std::size_t>(i)]);
  }
  const Expected<KabschFit> repeated = FitKabsch(b, a);
  ASSERT_TRUE(weighted && repeated);
  EXPECT_LT(RotationDistance(weighted->b_from_a.rotation, repeated->b_from_a.rotation), 1e-12);
  EXPECT_NEAR(weighted->sum_squares, repeated->sum_squares, 1e-12);
}

}  // namespace
}  // namespace sextant
