// SPDX-License-Identifier: Apache-2.0
// refine(x, intrinsics=...): pose and camera together, from a camera that is wrong.
#include "solvers/refine/refine_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "eval/synthetic/random_scene.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/make_solver.h"

namespace sextant {
namespace {

using test::MakeSolver;
using testing::HasSubstr;

// A scene whose problem states other intrinsics than those that made the pixels.
RandomScene WronglyCalibrated(RandomSceneOptions options, Random& random) {
  options.extent_m = 1.2;
  RandomScene scene = MakeRandomScene(options, random);
  Camera& stated = *scene.problem.camera;
  stated.fx_px *= random.Uniform(0.8, 1.2);
  stated.fy_px *= random.Uniform(0.8, 1.2);
  return scene;
}

struct CameraCase {
  const char* intrinsics;
  bool both;  // 3D-3D pairs too.
  bool state_noise;
};

void PrintTo(const CameraCase& c, std::ostream* out) {
  *out << c.intrinsics << (c.both ? ", both kinds" : "") << (c.state_noise ? "" : ", no sigmas");
}

class RefineCamera : public testing::TestWithParam<CameraCase> {};

// The pose's NEES / 6 is chi-square(6) / 6 where the noise is stated, and F(6, f) where it is
// estimated from f redundant residuals; a focal length's squared error in sigmas is chi-square(1)
// or F(1, f). The tolerance is five standard errors of the trials, and 3 percent for effects of
// second order.
TEST_P(RefineCamera, RecoversTheTruthWithinItsSigmas) {
  constexpr int kTrials = 500;
  constexpr int kPairs = 40;
  const CameraCase& c = GetParam();
  const SolverPtr solver = MakeSolver(std::string("refine(epnp,intrinsics=") + c.intrinsics +
                                      (c.both ? ",on=both)" : ")"));
  double nees = 0.0;
  double focal = 0.0;
  double unknowns = 6.0;
  Random random(1);
  for (int trial = 0; trial < kTrials; ++trial) {
    RandomScene scene = WronglyCalibrated(
        {.pairs = kPairs, .sigma_m = 0.01, .sigma_px = 0.5, .depth_m = 3.5}, random);
    if (std::string(c.intrinsics).find("distortion") != std::string::npos) {
      scene.problem.camera->model = CameraModel::kBrownConrady;
      scene.problem.camera->distortion = {0.02, -0.01, 1e-3, 1e-3};
    }
    if (!c.both) scene.problem.pairs_3d3d.clear();
    if (!c.state_noise) {
      for (Pair2d3d& pair : scene.problem.pairs_2d3d) pair.sigma_px = 0.0;
    }
    const Expected<SolveReport> report = solver->Solve(scene.problem);
    ASSERT_TRUE(report) << report.error().message;
    ASSERT_TRUE(report->camera && report->covariance);
    const EstimatedIntrinsic& fx = report->camera->estimated.front();
    EXPECT_EQ(fx.name, "fx_px");
    focal += std::pow((fx.value - 700.0) / *fx.sigma, 2);
    const Vector6d error = PoseDifference(report->cam_from_lidar, scene.cam_from_lidar);
    nees += SquaredMahalanobis(error, *report->covariance) / 6.0;
    unknowns = 6.0 + static_cast<double>(report->camera->estimated.size());
  }
  const double f = 2.0 * kPairs - unknowns;
  const double mean = c.state_noise ? 1.0 : f / (f - 2.0);
  const auto variance = [&](double m) {
    return c.state_noise ? 2.0 / m : 2.0 * mean * mean * (m + f - 2.0) / (m * (f - 4.0));
  };
  EXPECT_NEAR(nees / kTrials, mean, 5.0 * std::sqrt(variance(6.0) / kTrials) + 0.03);
  EXPECT_NEAR(focal / kTrials, mean, 5.0 * std::sqrt(variance(1.0) / kTrials) + 0.03);
}

INSTANTIATE_TEST_SUITE_P(Every, RefineCamera,
                         testing::Values(CameraCase{"focal", false, true},
                                         CameraCase{"focal", false, false},
                                         CameraCase{"focal", true, true},
                                         CameraCase{"focal+center", false, true},
                                         CameraCase{"focal+center+distortion", false, true}));

TEST(RefineCamera, WrongFocalLengthsBiasThePoseIfFixed) {
  const SolverPtr keeps = MakeSolver("refine(epnp)");
  const SolverPtr frees = MakeSolver("refine(epnp,intrinsics=focal)");
  double kept = 0.0;
  double freed = 0.0;
  Random random(2);
  for (int trial = 0; trial < 50; ++trial) {
    const RandomScene scene = WronglyCalibrated({.pairs = 30, .sigma_px = 0.5}, random);
    const Expected<SolveReport> a = keeps->Solve(scene.problem);
    const Expected<SolveReport> b = frees->Solve(scene.problem);
    ASSERT_TRUE(a && b);
    EXPECT_FALSE(a->camera);
    kept += DistanceBetween(a->cam_from_lidar, scene.cam_from_lidar).translation_m;
    freed += DistanceBetween(b->cam_from_lidar, scene.cam_from_lidar).translation_m;
    // Residuals use the estimated camera: they show the noise, not the wrong focal lengths.
    EXPECT_LT(*b->evaluation.rmse_px, 1.5);
  }
  EXPECT_LT(freed, 0.2 * kept);
}

TEST(RefineCamera, RobustLossesApply) {
  Random random(3);
  RandomScene scene = WronglyCalibrated({.pairs = 60, .sigma_px = 0.5}, random);
  for (std::size_t i = 0; i < 6; ++i) scene.problem.pairs_2d3d[10 * i].pixel.x() += 30.0;
  const auto error = [&](const std::string& options) {
    const auto report =
        MakeSolver("refine(epnp,intrinsics=focal" + options + ")")->Solve(scene.problem);
    EXPECT_TRUE(report) << report.error().message;
    return DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar).translation_m;
  };
  EXPECT_LT(error(",loss=cauchy,max_iterations=200"), 0.3 * error(""));
}

// One plane that faces the camera, and for more than the focal lengths one plane of any tilt.
TEST(RefineCamera, RefusesUnobservableIntrinsics) {
  Random random(4);
  int refused = 0;
  for (int trial = 0; trial < 20; ++trial) {
    RandomScene scene = MakeRandomScene({.pairs = 20, .sigma_px = 1.0}, random);
    const Rigid3d lidar_from_cam = scene.cam_from_lidar.Inverse();
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
      const Eigen::Vector2d normalized = pair.pixel - Eigen::Vector2d(639.5, 359.5);
      pair.point_in_lidar =
          lidar_from_cam *
          (3.0 / 700.0 * normalized).homogeneous().cwiseProduct(Eigen::Vector3d(1.0, 1.0, 3.0));
      pair.pixel.x() += random.Normal();
      pair.pixel.y() += random.Normal();
    }
    const auto report = MakeSolver("refine(epnp,intrinsics=focal)")->Solve(scene.problem);
    if (report) continue;
    ++refused;
    EXPECT_EQ(report.error().code, ErrorCode::kDegenerate) << report.error().message;
    EXPECT_THAT(report.error().message, HasSubstr("depths"));
  }
  EXPECT_GE(refused, 19);

  RandomScene plane = MakeRandomScene({.pairs = 20, .sigma_px = 1.0, .planar = true}, random);
  const auto all = MakeSolver("refine(epnp,intrinsics=focal+center)")->Solve(plane.problem);
  ASSERT_FALSE(all);
  EXPECT_EQ(all.error().code, ErrorCode::kDegenerate) << all.error().message;
  // Points in both frames determine the plane, and so the camera.
  RandomScene both =
      MakeRandomScene({.pairs = 40, .sigma_m = 0.01, .sigma_px = 1.0, .planar = true}, random);
  EXPECT_TRUE(MakeSolver("refine(kabsch,on=both,intrinsics=focal)")->Solve(both.problem));
}

TEST(RefineCamera, NeedsAsManyResidualsAsUnknowns) {
  Random random(5);
  RandomScene scene = MakeRandomScene({.pairs = 4, .sigma_px = 0.1}, random);
  const auto report = MakeSolver("refine(epnp,intrinsics=focal+center)")->Solve(scene.problem);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kTooFewPairs);
  EXPECT_THAT(report.error().message, HasSubstr("10 unknowns"));
  const auto pinhole = MakeSolver("refine(epnp,intrinsics=distortion)")->Solve(scene.problem);
  ASSERT_FALSE(pinhole);
  EXPECT_EQ(pinhole.error().code, ErrorCode::kInvalidInput);
}

TEST(RefineCamera, OptionsAreASetOfNames) {
  const SolverRegistry registry = BuiltinSolvers();
  EXPECT_TRUE(registry.Make("refine(epnp,intrinsics=none)"));
  EXPECT_TRUE(registry.Make("refine(epnp,intrinsics=distortion+focal)"));
  EXPECT_THAT(registry.Make("refine(epnp,intrinsics=focal+centre)").error().message,
              HasSubstr("did you mean 'center'?"));
  for (const char* spec :
       {"refine(epnp,intrinsics=focal+)", "refine(kabsch,intrinsics=focal)",
        "ransac(refine(epnp,intrinsics=focal))", "average(refine(epnp,intrinsics=focal))",
        "refine(refine(epnp,intrinsics=focal))"}) {
    EXPECT_EQ(registry.Make(spec).error().code, ErrorCode::kInvalidOption) << spec;
  }
}

}  // namespace
}  // namespace sextant
