// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/reprojection_covariance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::MakeScene;
using test::PairScene;

TEST(ReprojectionCovariance, IsTheInverseOfTheProjectionsDerivatives) {
  Random random(1);
  const PairScene scene = MakeScene({.pairs = 20, .sigma_px = 0.5}, random);
  const Camera& camera = *scene.problem.camera;
  Matrix6d information = Matrix6d::Zero();
  for (const Pair2d3d& pair : scene.problem.pairs_2d3d) {
    Eigen::Matrix<double, 2, 6> numeric;
    for (int k = 0; k < 6; ++k) {
      constexpr double kStep = 1e-6;
      const auto pixel_at = [&](double step) {
        const Rigid3d pose = Perturb(scene.cam_from_lidar, step * Vector6d::Unit(k));
        return *Project(camera, pose * pair.point_in_lidar);
      };
      numeric.col(k) = (pixel_at(kStep) - pixel_at(-kStep)) / (2.0 * kStep);
    }
    information += numeric.transpose() * numeric / (pair.sigma_px * pair.sigma_px);
  }
  const auto covariance =
      ReprojectionCovariance(camera, scene.problem.pairs_2d3d, scene.cam_from_lidar);
  ASSERT_TRUE(covariance);
  EXPECT_TRUE((*covariance * information).isIdentity(1e-4));
}

TEST(ReprojectionCovariance, EstimatesUnstatedNoiseFromTheResiduals) {
  Random random(3);
  PairScene scene = MakeScene({.pairs = 500, .sigma_px = 0.7}, random);
  std::vector<Pair2d3d>& pairs = scene.problem.pairs_2d3d;
  const Camera& camera = *scene.problem.camera;
  const auto stated = ReprojectionCovariance(camera, pairs, scene.cam_from_lidar);
  EXPECT_EQ(UnstatedVariance(camera, pairs, scene.cam_from_lidar), 0.0);
  for (Pair2d3d& pair : pairs) pair.sigma_px = 0.0;
  const auto measured = ReprojectionCovariance(camera, pairs, scene.cam_from_lidar);
  ASSERT_TRUE(stated && measured);
  // Five standard errors of the variance of 1000 residuals.
  EXPECT_NEAR(measured->trace() / stated->trace(), 1.0, 5.0 * std::sqrt(2.0 / 1000.0));
}

TEST(ReprojectionCovariance, IsNoneWhereUndetermined) {
  Random random(4);
  PairScene scene = MakeScene({.pairs = 3}, random);
  std::vector<Pair2d3d>& pairs = scene.problem.pairs_2d3d;
  const Camera& camera = *scene.problem.camera;
  const Rigid3d& pose = scene.cam_from_lidar;
  EXPECT_FALSE(ReprojectionCovariance(camera, pairs, pose)) << "no residual to judge by";
  EXPECT_FALSE(ReprojectionCovariance(camera, {}, pose));
  for (Pair2d3d& pair : pairs) pair.sigma_px = 1.0;
  EXPECT_TRUE(ReprojectionCovariance(camera, pairs, pose));
  EXPECT_FALSE(ReprojectionCovariance(camera, std::span(pairs).first(2), pose)) << "singular";
  const Rigid3d away{Eigen::Quaterniond(0.0, 0.0, 1.0, 0.0) * pose.rotation, -pose.translation};
  EXPECT_FALSE(ReprojectionCovariance(camera, pairs, away)) << "behind the camera";
}

}  // namespace
}  // namespace sextant
