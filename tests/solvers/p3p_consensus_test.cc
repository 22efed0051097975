// SPDX-License-Identifier: Apache-2.0
// refine(p3p) and ransac(p3p): success rates, and errors relative to the Cramer-Rao bound.
#include "solvers/robust/p3p_consensus.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "eval/metrics/bounds.h"
#include "eval/synthetic/mismatched_pairs.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/refine/p3p_start.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::MakeScene;
using test::PairScene;
using test::SceneOptions;

// Chi-square with 6 degrees of freedom exceeds this once in 10^9: the answer is wrong.
constexpr double kWrong = 53.0;

/// RMS of the errors relative to the bound, and the number of wrong answers.
struct Score {
  int wrong = 0;
  int right = 0;
  double squares = 0.0;

  void Add(const Expected<SolveReport>& report, const PairScene& scene, const Matrix6d& bound) {
    const Vector6d error =
        report ? PoseDifference(report->cam_from_lidar, scene.cam_from_lidar) : Vector6d();
    const double squared = report ? SquaredMahalanobis(error, bound) : kWrong;
    if (!(squared < kWrong)) {
      ++wrong;
      return;
    }
    ++right;
    squares += squared;
  }
  double Ratio() const { return std::sqrt(squares / (6.0 * right)); }
};

// With the first `count` pixels.
Matrix6d BoundOf(const PairScene& scene, int pairs) {
  CalibrationProblem pixels = scene.problem;
  pixels.pairs_3d3d.clear();
  pixels.pairs_2d3d.resize(static_cast<std::size_t>(pairs));
  return *CramerRaoBound(pixels, scene.cam_from_lidar);
}

TEST(RefinedP3p, IsAtTheBound) {
  const SolverPtr solver = *BuiltinSolvers().Make("refine(p3p)");
  for (const int pairs : {8, 20, 100, 1000}) {
    const int trials = pairs < 100 ? 4000 : 100'000 / pairs;
    Score score;
    for (int trial = 0; trial < trials; ++trial) {
      Random random(DeriveSeed(1, "refined_p3p", static_cast<std::uint64_t>(pairs),
                               static_cast<std::uint64_t>(trial)));
      const PairScene scene = MakeScene({.pairs = pairs, .sigma_px = 1.0}, random);
      score.Add(solver->Solve(scene.problem), scene, BoundOf(scene, pairs));
    }
    // At most one in a thousand. The goal is 1.02, 4 standard errors of the ratio of many trials.
    EXPECT_LE(score.wrong, trials / 1000) << pairs;
    EXPECT_LE(score.Ratio(), std::max(1.02, 1.0 + 4.0 / std::sqrt(12.0 * trials))) << pairs;
  }
}

// Pairs without sigmas, and pairs with an outlier, lead to the same minimum.
TEST(RefinedP3p, FindsTheMinimumThatRefinementOfOthersFinds) {
  const SolverPtr ours = *BuiltinSolvers().Make("refine(p3p)");
  const SolverPtr other = *BuiltinSolvers().Make("refine(sqpnp)");
  Random random(2);
  for (int trial = 0; trial < 200; ++trial) {
    PairScene scene = MakeScene({.pairs = 12, .sigma_px = 1.0}, random);
    if (trial % 2 == 0) {
      for (Pair2d3d& pair : scene.problem.pairs_2d3d) pair.sigma_px = 0.0;
    } else {
      scene.problem.pairs_2d3d[5].pixel.x() += 20.0;
    }
    const Expected<SolveReport> a = ours->Solve(scene.problem);
    const Expected<SolveReport> b = other->Solve(scene.problem);
    ASSERT_TRUE(a && b) << trial;
    EXPECT_LT(DistanceBetween(a->cam_from_lidar, b->cam_from_lidar).rotation_rad, 1e-8) << trial;
    ASSERT_TRUE(a->covariance && b->covariance);
    EXPECT_TRUE(a->covariance->isApprox(*b->covariance, 1e-4)) << trial;
  }
}

TEST(StartFromTriples, HasNoPoseForPointsOnALine) {
  PixelTerms terms;
  const Camera camera{.fx_px = 700.0, .fy_px = 700.0, .cx_px = 640.0, .cy_px = 360.0};
  for (int i = 0; i < 10; ++i) {
    const Eigen::Vector3d point(0.1 * i, 0.2 * i, 3.0 + 0.1 * i);
    terms.push_back({*Project(camera, point), point, 1.0});
  }
  EXPECT_FALSE(StartFromTriples(terms.View(), camera));
  EXPECT_FALSE(FindP3pConsensus(terms.View(), camera, {}).found);
}

PairScene Mismatched(int pairs, double outliers, std::uint64_t trial) {
  Random random(DeriveSeed(3, "mismatched", static_cast<std::uint64_t>(100.0 * outliers), trial));
  const SceneOptions options{.pairs = pairs, .sigma_px = 1.0};
  PairScene scene = MakeScene(options, random);
  MismatchPairs(options, InlierCount(pairs, outliers), random, scene);
  return scene;
}

TEST(RansacOfP3p, IsAtTheBoundOfTheTruePairs) {
  const SolverPtr solver = *BuiltinSolvers().Make("ransac(p3p, threshold=4)");
  for (const double outliers : {0.0, 0.2, 0.5, 0.8}) {
    constexpr int kTrials = 500;
    Score score;
    for (int trial = 0; trial < kTrials; ++trial) {
      const PairScene scene = Mismatched(100, outliers, static_cast<std::uint64_t>(trial));
      score.Add(solver->Solve(scene.problem), scene, BoundOf(scene, InlierCount(100, outliers)));
    }
    EXPECT_EQ(score.wrong, 0) << outliers;
    // The goal; two standard errors of the ratio of these trials are 0.026.
    EXPECT_LE(score.Ratio(), 1.03) << outliers;
  }
}

TEST(P3pConsensus, IsTheSameForTheSameSeedAndDrawsNoMoreThanAllowed) {
  const PairScene scene = Mismatched(60, 0.5, 0);
  const PairTerms terms = MakeTerms(scene.problem, PairKind::k2d3d);
  const auto find = [&](std::uint64_t seed, int max_samples) {
    return FindP3pConsensus(terms.pixels.View(), terms.camera,
                            {.max_samples = max_samples, .seed = seed});
  };
  const P3pConsensus once = find(1, 10000);
  const P3pConsensus again = find(1, 10000);
  EXPECT_EQ(once.cam_from_lidar.Matrix(), again.cam_from_lidar.Matrix());
  EXPECT_EQ(once.samples, again.samples);
  // Another seed leads to the same minimum.
  const P3pConsensus other = find(2, 10000);
  EXPECT_LT(DistanceBetween(once.cam_from_lidar, other.cam_from_lidar).rotation_rad, 1e-8);
  EXPECT_EQ(find(1, 5).samples, 5);
}

}  // namespace
}  // namespace sextant
