// SPDX-License-Identifier: Apache-2.0
#include "solvers/least_squares/refine_pose.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/least_squares/term_derivatives.h"
#include "solvers/refine/refine_ceres.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::MakeScene;
using test::PairScene;

Vector6d NormalTwist(Random& random, double sigma) {
  Vector6d v;
  for (int i = 0; i < 6; ++i) v[i] = sigma * random.Normal();
  return v;
}

// Stated noise along the viewing ray ten times that across it, as for the depth of a tag.
void MakeDepthUncertain(Random& random, PairScene& scene) {
  for (Pair3d3d& pair : scene.problem.pairs_3d3d) {
    const Eigen::Vector3d ray = pair.point_in_cam.normalized();
    const double across = 0.003;
    const double along = 0.03;
    const Eigen::Matrix3d covariance = across * across * Eigen::Matrix3d::Identity() +
                                       (along * along - across * across) * ray * ray.transpose();
    Eigen::Vector3d unit;
    for (int k = 0; k < 3; ++k) unit[k] = random.Normal();
    pair.point_in_cam += covariance.llt().matrixL() * unit;
    pair.covariance_in_cam = covariance;
  }
}

enum class Kinds { kPoints, kPixels, kBoth };

PairTerms TermsOf(const CalibrationProblem& problem, Kinds kinds) {
  PairTerms terms;
  if (kinds != Kinds::kPixels) terms.Add(problem.pairs_3d3d);
  if (kinds != Kinds::kPoints) terms.Add(problem.pairs_2d3d, *problem.camera);
  return terms;
}

std::vector<Camera> Cameras() {
  const Camera pinhole{.width_px = 1280,
                       .height_px = 720,
                       .fx_px = 700.0,
                       .fy_px = 690.0,
                       .cx_px = 639.5,
                       .cy_px = 359.5};
  Camera brown = pinhole;
  brown.model = CameraModel::kBrownConrady;
  brown.distortion = {-0.1, 0.02, 1e-3, -2e-3};
  Camera fisheye = pinhole;
  fisheye.model = CameraModel::kEquidistant;
  fisheye.distortion = {0.02, -0.01, 0.003, -0.001};
  return {pinhole, brown, fisheye};
}

template <int kResiduals, class Term>
void ExpectDerivativesOf(const Term& term, const Camera* camera, const Rigid3d& pose) {
  const auto at = [&](const Rigid3d& there, TermDerivatives<kResiduals>& out) {
    return Differentiate(term, camera, there.rotation.toRotationMatrix(), there.translation, out);
  };
  TermDerivatives<kResiduals> here;
  ASSERT_TRUE(at(pose, here));
  const auto jacobian = here.Jacobian();
  constexpr double kStep = 1e-5;
  for (int k = 0; k < 6; ++k) {
    const Vector6d step = kStep * Vector6d::Unit(k);
    TermDerivatives<kResiduals> forward;
    TermDerivatives<kResiduals> backward;
    ASSERT_TRUE(at(Perturb(pose, step), forward) && at(Perturb(pose, -step), backward));
    const auto numeric = ((forward.residual - backward.residual) / (2.0 * kStep)).eval();
    EXPECT_LT((numeric - jacobian.col(k)).norm(), 1e-6 * (1.0 + jacobian.norm()));
  }
}

TEST(TermDerivatives, AreThoseOfTheResidual) {
  Random random(1);
  PairScene scene = MakeScene({.pairs = 10, .sigma_m = 0.01, .sigma_px = 1.0}, random);
  MakeDepthUncertain(random, scene);
  for (const Camera& camera : Cameras()) {
    scene.problem.camera = camera;
    const PairTerms terms = TermsOf(scene.problem, Kinds::kBoth);
    const Rigid3d pose = Perturb(scene.cam_from_lidar, NormalTwist(random, 0.02));
    for (const PointTerm& term : terms.points) ExpectDerivativesOf<3>(term, nullptr, pose);
    for (const PixelTerm term : terms.pixels) ExpectDerivativesOf<2>(term, &camera, pose);
  }
}

TEST(RefinePose, AgreesWithCeresOnEveryKindAndCamera) {
  Random random(2);
  for (const Camera& camera : Cameras()) {
    for (const Kinds kinds : {Kinds::kPoints, Kinds::kPixels, Kinds::kBoth}) {
      PairScene scene = MakeScene({.pairs = 20, .sigma_px = 1.0}, random);
      scene.problem.camera = camera;
      for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
        pair.pixel = *Project(camera, scene.cam_from_lidar * pair.point_in_lidar);
        pair.pixel.x() += random.Normal();
      }
      MakeDepthUncertain(random, scene);
      const PairTerms terms = TermsOf(scene.problem, kinds);
      const Rigid3d start = Perturb(scene.cam_from_lidar, NormalTwist(random, 0.05));
      const RefinedPose ours = RefinePose(terms.View(), start, {});
      const RefinedPose theirs = RefinePoseWithCeres(terms.View(), start, {}, {});
      ASSERT_EQ(ours.outcome, RefineOutcome::kConverged);
      ASSERT_EQ(theirs.outcome, RefineOutcome::kConverged);
      const PoseDistance distance = DistanceBetween(ours.cam_from_lidar, theirs.cam_from_lidar);
      EXPECT_LT(distance.rotation_rad, 1e-9);
      EXPECT_LT(distance.translation_m, 1e-9);
      EXPECT_NEAR(ours.cost, theirs.cost, 1e-9 * ours.cost);

      const std::optional<Matrix6d> covariance = InvertSymmetric(ours.information);
      const std::optional<Matrix6d> reference = CeresCovariance(terms.View(), ours.cam_from_lidar);
      ASSERT_TRUE(covariance && reference);
      EXPECT_TRUE(covariance->isApprox(*reference, 1e-8));
    }
  }
}

TEST(RefinePose, NeverEndsWorseThanItStarted) {
  Random random(3);
  int converged = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const PairScene scene = MakeScene({.pairs = 8, .sigma_m = 0.01, .sigma_px = 1.0}, random);
    const PairTerms terms = TermsOf(scene.problem, Kinds::kPixels);
    const Rigid3d start = Perturb(scene.cam_from_lidar, NormalTwist(random, 0.3));
    const RefinedPose there = RefinePose(terms.View(), start, {.max_iterations = 1});
    const RefinedPose refined = RefinePose(terms.View(), start, {});
    if (there.outcome == RefineOutcome::kNotProjected) {
      EXPECT_EQ(refined.outcome, RefineOutcome::kNotProjected);
      continue;
    }
    EXPECT_LE(refined.cost, there.cost * (1.0 + 1e-12));
    converged += refined.outcome == RefineOutcome::kConverged ? 1 : 0;
  }
  EXPECT_GT(converged, 400);
}

TEST(RefinePose, RefusesAStartThatDoesNotProject) {
  Random random(4);
  const PairScene scene = MakeScene({.pairs = 8}, random);
  const PairTerms terms = TermsOf(scene.problem, Kinds::kPixels);
  Rigid3d behind = scene.cam_from_lidar;
  behind.translation.z() -= 10.0;
  EXPECT_EQ(RefinePose(terms.View(), behind, {}).outcome, RefineOutcome::kNotProjected);
  EXPECT_EQ(RefinePoseWithCeres(terms.View(), behind, {}, {}).outcome,
            RefineOutcome::kNotProjected);
}

struct NeesCase {
  Kinds kinds;
  bool state_noise;
};

class RefinePoseNees : public testing::TestWithParam<NeesCase> {};

// NEES / 6 is chi-square(6) / 6 with stated noise, and F(6, f) with f redundant residuals where the
// scale is estimated: mean f / (f - 2), variance 2 f^2 (f + 4) / (6 (f - 2)^2 (f - 4)). Five
// standard errors of 2000 trials are allowed, and 1 percent for effects of second order.
TEST_P(RefinePoseNees, IsThatOfAConsistentCovariance) {
  constexpr int kTrials = 2000;
  const auto [kinds, state_noise] = GetParam();
  double sum = 0.0;
  double freedom = 0.0;
  Random random(6);
  for (int trial = 0; trial < kTrials; ++trial) {
    PairScene scene = MakeScene({.pairs = 20, .sigma_px = 0.5}, random);
    if (kinds != Kinds::kPixels && state_noise) MakeDepthUncertain(random, scene);
    if (!state_noise) {
      for (Pair3d3d& pair : scene.problem.pairs_3d3d) {
        for (int k = 0; k < 3; ++k) pair.point_in_cam[k] += 0.004 * random.Normal();
      }
      for (Pair2d3d& pair : scene.problem.pairs_2d3d) pair.sigma_px = 0.0;
    }
    const PairTerms terms = TermsOf(scene.problem, kinds);
    const RefinedPose refined = RefinePose(terms.View(), scene.cam_from_lidar, {});
    ASSERT_EQ(refined.outcome, RefineOutcome::kConverged);
    const std::optional<Matrix6d> covariance =
        LeastSquaresCovariance(terms, refined.information, refined.cost);
    ASSERT_TRUE(covariance);
    const Vector6d error = PoseDifference(refined.cam_from_lidar, scene.cam_from_lidar);
    sum += SquaredMahalanobis(error, *covariance) / 6.0;
    freedom = 3.0 * static_cast<double>(terms.points.size()) +
              2.0 * static_cast<double>(terms.pixels.size()) - 6.0;
  }
  const double f = freedom;
  const double mean = state_noise ? 1.0 : f / (f - 2.0);
  const double variance =
      state_noise ? 2.0 / 6.0 : 2.0 * f * f * (f + 4.0) / (6.0 * (f - 2.0) * (f - 2.0) * (f - 4.0));
  EXPECT_NEAR(sum / kTrials, mean, 5.0 * std::sqrt(variance / kTrials) + 0.01);
}

INSTANTIATE_TEST_SUITE_P(Every, RefinePoseNees,
                         testing::Values(NeesCase{Kinds::kPoints, true},
                                         NeesCase{Kinds::kPixels, true},
                                         NeesCase{Kinds::kBoth, true},
                                         NeesCase{Kinds::kPoints, false},
                                         NeesCase{Kinds::kPixels, false}));

}  // namespace
}  // namespace sextant
