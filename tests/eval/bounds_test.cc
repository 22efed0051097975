// SPDX-License-Identifier: Apache-2.0
#include "eval/bounds.h"

#include <gtest/gtest.h>

#include <cmath>

#include "solvers/pair_noise.h"
#include "support/scenes.h"

namespace sextant {
namespace {

TEST(CramerRaoBound, OfOnePointClusterAtTheOriginIsTheMeanOfItsNoise) {
  // Symmetric axes: the translation decouples and is known to sigma / sqrt(n) per axis.
  CalibrationProblem problem;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double sign : {-1.0, 1.0}) {
      Pair3d3d pair;
      pair.point_in_lidar[axis] = sign;
      pair.point_in_cam = pair.point_in_lidar;
      pair.sigma_m = 0.3;
      problem.pairs_3d3d.push_back(pair);
    }
  }
  const Expected<Matrix6d> bound = CramerRaoBound(problem, Rigid3d{});
  ASSERT_TRUE(bound) << bound.error().message;
  Matrix6d expected = Matrix6d::Identity();
  expected.topLeftCorner<3, 3>() *= 0.09 / 4.0;  // Four of the six points have a lever of 1 m.
  expected.bottomRightCorner<3, 3>() *= 0.09 / 6.0;
  EXPECT_LT((*bound - expected).norm(), 1e-15);
  EXPECT_NEAR(RmsOf(*bound).translation_m, std::sqrt(3.0 * 0.09 / 6.0), 1e-15);
}

TEST(CramerRaoBound, EqualsThePropagatedCovarianceWithoutNoiseInTheData) {
  Random random(1);
  test::Scene scene = test::MakeScene({.pairs = 10}, random);
  for (Pair3d3d& pair : scene.problem.pairs_3d3d) pair.sigma_m = 0.01;
  scene.problem.pairs_2d3d.clear();
  const auto bound = CramerRaoBound(scene.problem, scene.cam_from_lidar);
  const auto propagated = PropagateCovariance(
      scene.problem.pairs_3d3d, IsotropicWeights(scene.problem.pairs_3d3d), scene.cam_from_lidar);
  ASSERT_TRUE(bound && propagated);
  EXPECT_LT((*bound - *propagated).norm(), 1e-10 * bound->norm());
}

TEST(CramerRaoBound, BothKindsOfPairsAddTheirInformation) {
  Random random(2);
  const test::Scene scene =
      test::MakeScene({.pairs = 10, .sigma_m = 0.01, .sigma_px = 1.0}, random);
  CalibrationProblem points = scene.problem;
  points.pairs_2d3d.clear();
  CalibrationProblem pixels = scene.problem;
  pixels.pairs_3d3d.clear();
  const auto both = CramerRaoBound(scene.problem, scene.cam_from_lidar);
  const auto of_points = CramerRaoBound(points, scene.cam_from_lidar);
  const auto of_pixels = CramerRaoBound(pixels, scene.cam_from_lidar);
  ASSERT_TRUE(both && of_points && of_pixels);
  EXPECT_LT((both->inverse() - of_points->inverse() - of_pixels->inverse()).norm(),
            1e-8 * both->inverse().norm());
}

TEST(CramerRaoBound, SaysWhatIsMissing) {
  Random random(3);
  EXPECT_EQ(CramerRaoBound({}, {}).error().code, ErrorCode::kMissingData);
  const test::Scene silent = test::MakeScene({.pairs = 5}, random);
  EXPECT_EQ(CramerRaoBound(silent.problem, silent.cam_from_lidar).error().code,
            ErrorCode::kMissingData);
  test::Scene two = test::MakeScene({.pairs = 2, .sigma_m = 0.1}, random);
  two.problem.pairs_2d3d.clear();
  EXPECT_EQ(CramerRaoBound(two.problem, two.cam_from_lidar).error().code, ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace sextant
