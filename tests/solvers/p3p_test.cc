// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/p3p.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using Triple = std::array<Eigen::Vector3d, 3>;

struct TripleView {
  Triple rays;
  Triple points;
  Rigid3d cam_from_lidar;
};

TripleView SeenFrom(const Triple& in_cam, Random& random) {
  TripleView view;
  view.cam_from_lidar.rotation = ExpSo3(NormalVector(random));
  view.cam_from_lidar.translation = 0.3 * NormalVector(random);
  for (std::size_t i = 0; i < 3; ++i) {
    view.rays[i] = in_cam[i].normalized();
    view.points[i] = view.cam_from_lidar.Inverse() * in_cam[i];
  }
  return view;
}

Triple RandomTriple(double depth, Random& random) {
  Triple in_cam;
  for (Eigen::Vector3d& q : in_cam) {
    for (int k = 0; k < 3; ++k) q[k] = random.Uniform(-1.0, 1.0);
    q.z() = std::max(0.05, q.z() + depth);
  }
  return in_cam;
}

// The larger of rotation [rad] and translation over depth to the nearest solution.
double ErrorOfBest(const TripleView& view, double depth) {
  std::array<Rigid3d, kMaxP3pPoses> poses;
  const int count = SolveP3p(view.rays, view.points, poses);
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < count; ++i) {
    const PoseDistance d = DistanceBetween(poses[static_cast<std::size_t>(i)], view.cam_from_lidar);
    best = std::min(best, std::max(d.rotation_rad, d.translation_m / depth));
  }
  return best;
}

class P3pAtDepth : public testing::TestWithParam<double> {};

TEST_P(P3pAtDepth, TruePoseIsAmongTheSolutions) {
  Random random(1);
  for (int trial = 0; trial < 5000; ++trial) {
    const TripleView view = SeenFrom(RandomTriple(GetParam(), random), random);
    EXPECT_LT(ErrorOfBest(view, GetParam()), 1e-8) << trial;
  }
}

TEST_P(P3pAtDepth, EverySolutionSeesThePointsOnTheRays) {
  Random random(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const TripleView view = SeenFrom(RandomTriple(GetParam(), random), random);
    std::array<Rigid3d, kMaxP3pPoses> poses;
    const int count = SolveP3p(view.rays, view.points, poses);
    for (int k = 0; k < count; ++k) {
      const Rigid3d& pose = poses[static_cast<std::size_t>(k)];
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_LT(((pose * view.points[i]).normalized() - view.rays[i]).norm(), 1e-8);
      }
      for (int other = 0; other < k; ++other) {
        EXPECT_GT(RotationDistance(pose.rotation, poses[static_cast<std::size_t>(other)].rotation),
                  1e-9);
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(NearToDeep, P3pAtDepth, testing::Values(0.5, 3.0, 30.0, 1000.0));

// Symmetric triangles make both conics of the pencil degenerate.
TEST(P3p, SolvesSymmetricTriangles) {
  Random random(3);
  for (int trial = 0; trial < 1000; ++trial) {
    const double w = random.Uniform(0.1, 1.0);
    const double h = random.Uniform(0.1, 1.0);
    const double z = random.Uniform(2.0, 4.0);
    Triple isosceles = {Eigen::Vector3d(-w, 0.0, 3.0), {w, 0.0, 3.0}, {0.0, h, z}};
    std::rotate(isosceles.begin(), isosceles.begin() + trial % 3, isosceles.end());
    EXPECT_LT(ErrorOfBest(SeenFrom(isosceles, random), 3.0), 1e-8);
    const double x = random.Uniform(-1.0, 1.0);
    const Triple facing = {Eigen::Vector3d(x - w, -w, 3.0), {x + w, -w, 3.0}, {x + w, w, 3.0}};
    EXPECT_LT(ErrorOfBest(SeenFrom(facing, random), 3.0), 1e-8);
    Triple equilateral;
    for (std::size_t i = 0; i < 3; ++i) {
      const double angle = 2.0 * std::numbers::pi * static_cast<double>(i) / 3.0;
      equilateral[i] = {w * std::cos(angle), w * std::sin(angle), z};
    }
    EXPECT_LT(ErrorOfBest(SeenFrom(equilateral, random), 3.0), 1e-8);
  }
}

// Two solutions merge there and lose half of their digits.
TEST(P3p, SolvesOnTheDangerCylinder) {
  Random random(4);
  int far_off = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const double camera = random.Uniform(0.0, 2.0 * std::numbers::pi);
    Triple in_cam;
    for (Eigen::Vector3d& q : in_cam) {
      const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
      q = {std::cos(angle) - std::cos(camera), std::sin(angle) - std::sin(camera), 3.0};
    }
    if (ErrorOfBest(SeenFrom(in_cam, random), 3.0) > 1e-5) ++far_off;
  }
  EXPECT_LE(far_off, 5);  // Triangles of three almost equal angles.
}

TEST(P3p, SolvesCornersOfBoards) {
  Random random(5);
  for (int trial = 0; trial < 1000; ++trial) {
    const double half = 0.24 * std::sqrt(2.0);
    const Eigen::Quaterniond tilt = ExpSo3(0.3 * NormalVector(random));
    const Eigen::Vector3d centre(random.Uniform(-0.5, 0.5), random.Uniform(-0.3, 0.3), 1.8);
    const Triple in_cam = {tilt * Eigen::Vector3d(0, -half, 0) + centre,
                           tilt * Eigen::Vector3d(half, 0, 0) + centre,
                           tilt * Eigen::Vector3d(0, half, 0) + centre};
    EXPECT_LT(ErrorOfBest(SeenFrom(in_cam, random), 1.8), 1e-8);
  }
}

TEST(P3p, HasNoPoseForDegenerateTriples) {
  Random random(6);
  const Eigen::Vector3d a(0.1, 0.2, 3.0);
  const Eigen::Vector3d b(1.0, -0.3, 2.0);
  std::array<Rigid3d, kMaxP3pPoses> poses;
  const auto count = [&](const Triple& in_cam) {
    const TripleView view = SeenFrom(in_cam, random);
    return SolveP3p(view.rays, view.points, poses);
  };
  EXPECT_EQ(count({a, b, 0.3 * a + 0.7 * b}), 0);
  EXPECT_EQ(count({a, a, b}), 0);
  EXPECT_EQ(count({a, b, a}), 0);
  EXPECT_EQ(count({a, a, a}), 0);
}

// The largest distance between nearest poses of both; infinite where their counts differ.
double DifferenceOf(std::span<const Rigid3d> alone, const P3pPoses& together, std::size_t triple) {
  std::size_t count = 0;
  double worst = 0.0;
  for (std::size_t c = 0; c < kMaxP3pPoses; ++c) {
    if (together.exists[c][triple] == 0) continue;
    ++count;
    double nearest = std::numeric_limits<double>::infinity();
    for (const Rigid3d& pose : alone) {
      const PoseDistance d = DistanceBetween(pose, together.Pose(c, triple));
      nearest = std::min(nearest, std::max(d.rotation_rad, d.translation_m));
    }
    worst = std::max(worst, nearest);
  }
  return count == alone.size() ? worst : std::numeric_limits<double>::infinity();
}

TEST_P(P3pAtDepth, BatchHasThePosesOfEachTriple) {
  Random random(10);
  for (int batch = 0; batch < 500; ++batch) {
    std::array<TripleView, kSimdWidth> views;
    P3pTriples triples;
    for (std::size_t k = 0; k < kSimdWidth; ++k) {
      Triple in_cam = RandomTriple(GetParam(), random);
      // Some triples have no pose: collinear points, or one point twice.
      if (random.Uniform() < 0.05) in_cam[2] = 0.5 * (in_cam[0] + in_cam[1]);
      if (random.Uniform() < 0.05) in_cam[1] = in_cam[0];
      views[k] = SeenFrom(in_cam, random);
      for (std::size_t i = 0; i < 9; ++i) {
        const auto axis = static_cast<Eigen::Index>(i % 3);
        triples.rays[i][k] = views[k].rays[i / 3][axis];
        triples.points[i][k] = views[k].points[i / 3][axis];
      }
    }
    P3pPoses together;
    SolveP3pBatch(triples, together);
    for (std::size_t k = 0; k < kSimdWidth; ++k) {
      std::array<Rigid3d, kMaxP3pPoses> alone;
      const int count = SolveP3p(views[k].rays, views[k].points, alone);
      EXPECT_LT(DifferenceOf(std::span(alone).first(static_cast<std::size_t>(count)), together, k),
                1e-9 * GetParam() + 1e-9);
    }
  }
}

TEST(P3pSolver, ThreePairsGiveEverySolutionAndMoreChooseAmongThem) {
  const SolverPtr p3p = *BuiltinSolvers().Make("p3p");
  Random random(7);
  for (int trial = 0; trial < 200; ++trial) {
    test::PairScene scene = test::MakeScene({.pairs = 12}, random);
    const Expected<SolveReport> chosen = p3p->Solve(scene.problem);
    ASSERT_TRUE(chosen) << chosen.error().message;
    EXPECT_TRUE(chosen->alternatives.empty());
    EXPECT_EQ(chosen->inliers.size(), 12U);
    const PoseDistance off = DistanceBetween(chosen->cam_from_lidar, scene.cam_from_lidar);
    EXPECT_LT(off.rotation_rad, 1e-8);
    EXPECT_LT(off.translation_m, 3e-8);

    scene.problem.pairs_2d3d.resize(3);
    const Expected<SolveReport> all = p3p->Solve(scene.problem);
    ASSERT_TRUE(all) << all.error().message;
    double nearest = RotationDistance(all->cam_from_lidar.rotation, scene.cam_from_lidar.rotation);
    for (const Rigid3d& other : all->alternatives) {
      nearest = std::min(nearest, RotationDistance(other.rotation, scene.cam_from_lidar.rotation));
    }
    EXPECT_LT(nearest, 1e-8);
    EXPECT_LT(*all->evaluation.rmse_px, 1e-6);
  }
}

TEST(P3pSolver, ExplainsWhyThereIsNoPose) {
  const SolverPtr p3p = *BuiltinSolvers().Make("p3p");
  Random random(8);
  test::PairScene scene = test::MakeScene({.pairs = 3}, random);
  std::vector<Pair2d3d>& pairs = scene.problem.pairs_2d3d;
  const std::vector<Pair2d3d> kept = pairs;
  pairs[2] = pairs[1];
  EXPECT_EQ(p3p->Solve(scene.problem).error().code, ErrorCode::kDegenerate);
  pairs = kept;
  // A long side seen under a small angle, and the short ones under large angles.
  pairs[0].point_in_lidar = {0.0, 0.0, 0.0};
  pairs[1].point_in_lidar = {10.0, 0.0, 0.0};
  pairs[2].point_in_lidar = {5.0, 0.01, 0.0};
  pairs[0].pixel = {600.0, 360.0};
  pairs[1].pixel = {680.0, 360.0};
  pairs[2].pixel = {640.0, 10.0};
  EXPECT_EQ(p3p->Solve(scene.problem).error().code, ErrorCode::kNoConsensus);
}

// Without stated noise the pixels that choose the pose also give the noise.
TEST(P3pSolver, CovarianceIsConsistentWhereTheNoiseIsNotStated) {
  const SolverPtr p3p = *BuiltinSolvers().Make("p3p");
  constexpr int kTrials = 300;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Random random(DeriveSeed(9, "p3p", 0, static_cast<std::uint64_t>(trial)));
    test::PairScene scene = test::MakeScene({.pairs = 40, .sigma_px = 0.3}, random);
    const Expected<SolveReport> known = p3p->Solve(scene.problem);
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
      pair.sigma_px = 0.0;
      pair.id = {};  // On no board, so that no errors in common are looked for.
    }
    const Expected<SolveReport> unknown = p3p->Solve(scene.problem);
    ASSERT_TRUE(known && unknown);
    sum += unknown->covariance->trace() / known->covariance->trace();
  }
  // The 74 residuals of a trial have a relative error of sqrt(2 / 74) and little correlation.
  EXPECT_NEAR(sum / kTrials, 1.0, 0.05);
}

}  // namespace
}  // namespace sextant
