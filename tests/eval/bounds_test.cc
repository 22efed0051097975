// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/bounds.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "geometry/pair_noise.h"
#include "geometry/symmetric.h"
#include "solvers/refine/refine_ceres.h"
#include "support/scenes.h"

namespace sextant {
namespace {

TEST(CramerRaoBound, MatchesTheClosedFormForSymmetricPoints) {
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

TEST(CramerRaoBound, EqualsThePropagatedCovarianceForExactData) {
  Random random(1);
  test::PairScene scene = test::MakeScene({.pairs = 10}, random);
  for (Pair3d3d& pair : scene.problem.pairs_3d3d) pair.sigma_m = 0.01;
  scene.problem.pairs_2d3d.clear();
  const auto bound = CramerRaoBound(scene.problem, scene.cam_from_lidar);
  const auto propagated = PropagateCovariance(
      scene.problem.pairs_3d3d, IsotropicWeights(scene.problem.pairs_3d3d), scene.cam_from_lidar);
  ASSERT_TRUE(bound && propagated);
  EXPECT_LT((*bound - *propagated).norm(), 1e-10 * bound->norm());
}

TEST(CramerRaoBound, AddsTheInformationOfBothKindsOfPairs) {
  Random random(2);
  const test::PairScene scene =
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

// The Fisher information by finite differences of Project and the transform only.
Matrix6d NumericBound(const CalibrationProblem& problem, const Rigid3d& pose) {
  constexpr double kStep = 1e-5;
  Matrix6d information = Matrix6d::Zero();
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    Eigen::Matrix<double, 3, 6> by_pose;
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      by_pose.col(k) =
          (Perturb(pose, step) * pair.point_in_lidar - Perturb(pose, -step) * pair.point_in_lidar) /
          (2.0 * kStep * pair.sigma_m);
    }
    information += by_pose.transpose() * by_pose;
  }
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    Eigen::Matrix<double, 2, 6> by_pose;
    for (int k = 0; k < 6; ++k) {
      const Vector6d step = kStep * Vector6d::Unit(k);
      by_pose.col(k) = (*Project(*problem.camera, Perturb(pose, step) * pair.point_in_lidar) -
                        *Project(*problem.camera, Perturb(pose, -step) * pair.point_in_lidar)) /
                       (2.0 * kStep * pair.sigma_px);
    }
    information += by_pose.transpose() * by_pose;
  }
  return information.inverse();
}

// The bound, Ceres and our own least squares give the same covariance for points, pixels and both,
// also with distortion.
TEST(CramerRaoBound, EqualsTheCovarianceOfCeresAndRefinePoseAtTheTruth) {
  Random random(4);
  for (const bool distorted : {false, true}) {
    for (const unsigned kinds : {1U, 2U, 3U}) {
      RandomScene scene = MakeRandomScene({.pairs = 12, .sigma_m = 0.01, .sigma_px = 0.7}, random);
      CalibrationProblem& problem = scene.problem;
      if (distorted) {
        problem.camera->model = CameraModel::kBrownConrady;
        problem.camera->distortion = {-0.05, 0.01, 1e-3, -2e-3};
      }
      if ((kinds & 1U) == 0U) problem.pairs_3d3d.clear();
      if ((kinds & 2U) == 0U) problem.pairs_2d3d.clear();
      const Expected<Matrix6d> bound = CramerRaoBound(problem, scene.cam_from_lidar);
      ASSERT_TRUE(bound) << bound.error().message;
      EXPECT_TRUE(bound->isApprox(NumericBound(problem, scene.cam_from_lidar), 1e-6)) << kinds;

      PairTerms terms;
      terms.Add(problem.pairs_3d3d);
      terms.Add(problem.pairs_2d3d, *problem.camera);
      const std::optional<Matrix6d> ceres = CeresCovariance(terms.View(), scene.cam_from_lidar);
      ASSERT_TRUE(ceres);
      EXPECT_TRUE(ceres->isApprox(*bound, 1e-8)) << kinds;
      const RefinedPose at_truth =
          RefinePose(terms.View(), scene.cam_from_lidar, {.max_iterations = 1});
      EXPECT_TRUE(InvertSymmetric(at_truth.information)->isApprox(*bound, 1e-8)) << kinds;
    }
  }
}

TEST(CramerRaoBound, ReportsMissingData) {
  Random random(3);
  EXPECT_EQ(CramerRaoBound({}, {}).error().code, ErrorCode::kMissingData);
  const test::PairScene silent = test::MakeScene({.pairs = 5}, random);
  EXPECT_EQ(CramerRaoBound(silent.problem, silent.cam_from_lidar).error().code,
            ErrorCode::kMissingData);
  test::PairScene two = test::MakeScene({.pairs = 2, .sigma_m = 0.1}, random);
  two.problem.pairs_2d3d.clear();
  EXPECT_EQ(CramerRaoBound(two.problem, two.cam_from_lidar).error().code, ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace sextant
