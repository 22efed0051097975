// SPDX-License-Identifier: Apache-2.0
#include "solvers/opencv/opencv_solvers.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "support/scenes.h"

namespace sextant {
namespace {

SolverPtr MakeSolver(const std::string& spec) {
  SolverRegistry registry;
  AddOpenCvSolvers(registry);
  const Expected<SolverPtr> made = registry.Make(spec);
  EXPECT_TRUE(made) << made.error().message;
  return made ? *made : nullptr;
}

class OpenCvSolver : public testing::TestWithParam<std::string> {
 protected:
  bool planar() const { return GetParam() == "opencv.ippe"; }
};

TEST_P(OpenCvSolver, RecoversExactPosesThroughALens) {
  const SolverPtr solver = MakeSolver(GetParam());
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    test::PairScene scene = test::MakeScene({.pairs = 12, .planar = planar()}, random);
    Camera& camera = *scene.problem.camera;
    camera.model = CameraModel::kBrownConrady;
    camera.distortion = {-0.1, 0.02, 1e-3, -1e-3, 0.0, 0.0, 0.0, 0.0};
    for (Pair2d3d& pair : scene.problem.pairs_2d3d) {
      pair.pixel = *Project(camera, scene.cam_from_lidar * pair.point_in_lidar);
    }
    const Expected<SolveReport> report = solver->Solve(scene.problem);
    ASSERT_TRUE(report) << report.error().message;
    const PoseDistance error = DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar);
    // OpenCV's stopping rules, not ours.
    EXPECT_LT(error.rotation_rad, 1e-3) << trial;
    EXPECT_LT(error.translation_m, 3e-3) << trial;
  }
}

TEST_P(OpenCvSolver, GivesTheSameBitsTwice) {
  const SolverPtr solver = MakeSolver(GetParam());
  Random random(2);
  test::PairScene scene =
      test::MakeScene({.pairs = 40, .sigma_px = 1.0, .planar = planar()}, random);
  const std::size_t outliers = solver->spec().name.ends_with("iterative") ? 0 : 10;
  for (std::size_t i = 0; i < outliers; ++i) scene.problem.pairs_2d3d[i].pixel.x() += 50.0;
  const Expected<SolveReport> first = solver->Solve(scene.problem);
  const Expected<SolveReport> second = solver->Solve(scene.problem);
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->cam_from_lidar.rotation.coeffs(), second->cam_from_lidar.rotation.coeffs());
  EXPECT_EQ(first->cam_from_lidar.translation, second->cam_from_lidar.translation);
  EXPECT_EQ(first->inliers, second->inliers);
}

TEST_P(OpenCvSolver, RefusesPointsOnALine) {
  const SolverPtr solver = MakeSolver(GetParam());
  Random random(3);
  test::PairScene scene = test::MakeScene({.pairs = 8}, random);
  for (std::size_t i = 2; i < 8; ++i) {
    std::vector<Pair2d3d>& pairs = scene.problem.pairs_2d3d;
    const Eigen::Vector3d direction = pairs[1].point_in_lidar - pairs[0].point_in_lidar;
    pairs[i].point_in_lidar = pairs[0].point_in_lidar + 0.1 * static_cast<double>(i) * direction;
    pairs[i].pixel =
        *Project(*scene.problem.camera, scene.cam_from_lidar * pairs[i].point_in_lidar);
  }
  const Expected<SolveReport> report = solver->Solve(scene.problem);
  ASSERT_FALSE(report);
  EXPECT_EQ(report.error().code, ErrorCode::kDegenerate) << report.error().message;
}

INSTANTIATE_TEST_SUITE_P(All, OpenCvSolver,
                         testing::Values("opencv.epnp", "opencv.sqpnp", "opencv.ippe", "opencv.p3p",
                                         "opencv.iterative", "opencv.ransac_epnp", "opencv.magsac"),
                         [](const auto& test) { return test.param.substr(7); });

TEST(OpenCvRansac, LeavesOutliersOut) {
  for (const char* spec : {"opencv.ransac_epnp(threshold_px=4)", "opencv.magsac(threshold_px=4)"}) {
    const SolverPtr solver = MakeSolver(spec);
    ASSERT_TRUE(solver);
    Random random(4);
    test::PairScene scene = test::MakeScene({.pairs = 40, .sigma_px = 1.0}, random);
    for (std::size_t i = 0; i < 10; ++i) scene.problem.pairs_2d3d[i].pixel.y() -= 100.0;
    const Expected<SolveReport> report = solver->Solve(scene.problem);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_GE(report->inliers.size(), 20U) << spec;
    EXPECT_GE(report->inliers.front(), 10) << spec;
    const PoseDistance error = DistanceBetween(report->cam_from_lidar, scene.cam_from_lidar);
    EXPECT_LT(error.rotation_rad, 0.03) << spec;
    EXPECT_TRUE(report->covariance) << spec;
  }
}

}  // namespace
}  // namespace sextant
