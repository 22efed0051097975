// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/ippe.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <limits>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/scenes.h"

namespace sextant {
namespace {

struct PlanarView {
  std::vector<Eigen::Vector2d> image_points;
  std::vector<Eigen::Vector3d> points;
  Rigid3d cam_from_lidar;
};

struct PlanarViewOptions {
  int count = 4;
  double depth = 3.0;
  double max_tilt_rad = 0.8;  // About each axis; 0 faces the camera.
  double sigma = 0.0;         // Noise of the image points on the plane z = 1.
};

PlanarView MakePlanarView(const PlanarViewOptions& options, Random& random) {
  PlanarView view;
  view.cam_from_lidar.rotation = ExpSo3(UniformVector(random, 2.0));
  view.cam_from_lidar.translation = UniformVector(random, 0.5);
  const Eigen::Quaterniond tilt = ExpSo3(UniformVector(random, options.max_tilt_rad));
  const Eigen::Vector3d aside = 0.2 * UniformVector(random, options.depth);
  const Eigen::Vector3d centre(aside.x(), aside.y(), options.depth);
  for (int i = 0; i < options.count; ++i) {
    Eigen::Vector3d offset = UniformVector(random, 0.8);
    // Four random points may be close to three on a line: a board's corners instead.
    if (options.count == 4) offset = {i == 0 || i == 3 ? -0.5 : 0.5, i < 2 ? -0.4 : 0.4, 0.0};
    offset.z() = 0.0;
    const Eigen::Vector3d in_cam = tilt * offset + centre;
    const double noise_u = options.sigma * random.Normal();
    const double noise_v = options.sigma * random.Normal();
    view.image_points.push_back(in_cam.hnormalized() + Eigen::Vector2d(noise_u, noise_v));
    view.points.push_back(view.cam_from_lidar.Inverse() * in_cam);
  }
  return view;
}

// The larger of rotation [rad] and translation over depth to the nearer of both answers.
double ErrorOfBest(const PlanarView& view, const IppeFit& fit, double depth) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < fit.count; ++i) {
    const PoseDistance d =
        DistanceBetween(fit.cam_from_lidar[static_cast<std::size_t>(i)], view.cam_from_lidar);
    best = std::min(best, std::max(d.rotation_rad, d.translation_m / depth));
  }
  return best;
}

class IppeCounts : public testing::TestWithParam<int> {};

TEST_P(IppeCounts, TruePoseIsAmongBoth) {
  Random random(1);
  const int trials = GetParam() < 100 ? 1000 : 50;
  for (const double depth : {1.5, 3.0, 30.0, 1000.0}) {
    for (int trial = 0; trial < trials; ++trial) {
      const PlanarView view = MakePlanarView({.count = GetParam(), .depth = depth}, random);
      const Expected<IppeFit> fit = SolveIppe(view.image_points, view.points);
      ASSERT_TRUE(fit) << fit.error().message;
      EXPECT_LT(ErrorOfBest(view, *fit, depth), 1e-8) << "depth " << depth << " trial " << trial;
    }
  }
}

TEST_P(IppeCounts, FindsPlanesThatFaceTheCamera) {
  Random random(2);
  for (const double tilt : {0.0, 1e-9, 1e-6, 1e-3}) {
    for (int trial = 0; trial < 50; ++trial) {
      const PlanarView view = MakePlanarView({.count = GetParam(), .max_tilt_rad = tilt}, random);
      const Expected<IppeFit> fit = SolveIppe(view.image_points, view.points);
      ASSERT_TRUE(fit) << fit.error().message;
      EXPECT_LT(ErrorOfBest(view, *fit, 3.0), 1e-8) << "tilt " << tilt << " trial " << trial;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(FewToMany, IppeCounts, testing::Values(4, 5, 6, 8, 20, 1000));

TEST(Ippe, FirstAnswerFitsBetter) {
  Random random(3);
  for (int trial = 0; trial < 500; ++trial) {
    const PlanarView view = MakePlanarView({.count = 8, .sigma = 1.0 / 700.0}, random);
    const Expected<IppeFit> fit = SolveIppe(view.image_points, view.points);
    ASSERT_TRUE(fit) << fit.error().message;
    for (int k = 0; k < fit->count; ++k) {
      const auto i = static_cast<std::size_t>(k);
      double squares = 0.0;
      for (std::size_t p = 0; p < view.points.size(); ++p) {
        const Eigen::Vector3d q = fit->cam_from_lidar[i] * view.points[p];
        EXPECT_GT(q.z(), 0.0);
        squares += (view.image_points[p] - q.hnormalized()).squaredNorm();
      }
      EXPECT_NEAR(fit->sum_squares[i], squares, 1e-12);
    }
    EXPECT_TRUE(fit->count == 1 || fit->sum_squares[0] <= fit->sum_squares[1]);
  }
}

// Far away a tilt and its opposite have nearly the same image, and noise may favour either.
TEST(Ippe, ReportsBothTiltsOfADistantBoard) {
  Random random(4);
  int both = 0;
  int first_wrong = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const PlanarView view =
        MakePlanarView({.count = 4, .depth = 30.0, .sigma = 0.2 / 700.0}, random);
    const Expected<IppeFit> fit = SolveIppe(view.image_points, view.points);
    ASSERT_TRUE(fit) << fit.error().message;
    if (fit->count == 2) ++both;
    const double first =
        RotationDistance(fit->cam_from_lidar[0].rotation, view.cam_from_lidar.rotation);
    if (first > 2.0 * ErrorOfBest(view, *fit, 30.0) + 0.1) ++first_wrong;
  }
  EXPECT_GT(both, 190);
  EXPECT_GT(first_wrong, 10);
  EXPECT_LT(first_wrong, 100);
}

TEST(Ippe, AcceptsLidarNoiseAndRefusesPointsOffThePlane) {
  Random random(5);
  PlanarView view = MakePlanarView({.count = 20}, random);
  const Eigen::Vector3d normal =
      (view.points[1] - view.points[0]).cross(view.points[2] - view.points[0]).normalized();
  for (Eigen::Vector3d& point : view.points) point += 0.01 * random.Normal() * normal;
  EXPECT_TRUE(SolveIppe(view.image_points, view.points));
  view.points[3] += 1.0 * normal;
  const Expected<IppeFit> off = SolveIppe(view.image_points, view.points);
  ASSERT_FALSE(off);
  EXPECT_EQ(off.error().code, ErrorCode::kDegenerate);
  EXPECT_THAT(off.error().message, testing::HasSubstr("off their plane"));
}

TEST(Ippe, RefusesDegenerateSets) {
  Random random(6);
  const PlanarView view = MakePlanarView({.count = 4}, random);
  const auto code = [](const PlanarView& spoilt) {
    const Expected<IppeFit> fit = SolveIppe(spoilt.image_points, spoilt.points);
    return fit ? ErrorCode::kIo : fit.error().code;
  };
  PlanarView few = view;
  few.points.pop_back();
  few.image_points.pop_back();
  EXPECT_EQ(code(few), ErrorCode::kTooFewPairs);
  PlanarView twice = view;
  twice.points[3] = twice.points[2];
  twice.image_points[3] = twice.image_points[2];
  EXPECT_EQ(code(twice), ErrorCode::kDegenerate);
  PlanarView three_on_a_line = view;
  three_on_a_line.points[2] = 0.5 * (view.points[0] + view.points[1]);
  three_on_a_line.image_points[2] = (view.cam_from_lidar * three_on_a_line.points[2]).hnormalized();
  EXPECT_EQ(code(three_on_a_line), ErrorCode::kDegenerate);
  for (PlanarView* noisy : {&twice, &three_on_a_line}) {
    for (Eigen::Vector2d& point : noisy->image_points) point.x() += 1e-3 * random.Normal();
    EXPECT_EQ(code(*noisy), ErrorCode::kDegenerate);
  }
  PlanarView one_pixel = view;
  for (Eigen::Vector2d& point : one_pixel.image_points) point = {0.1, 0.2};
  EXPECT_EQ(code(one_pixel), ErrorCode::kDegenerate);
}

TEST(IppeSolver, ReportsTheOtherPoseAsAlternative) {
  const SolverPtr ippe = *BuiltinSolvers().Make("ippe");
  Random random(7);
  const test::PairScene scene =
      test::MakeScene({.pairs = 8, .sigma_px = 0.3, .planar = true, .depth_m = 40.0}, random);
  const Expected<SolveReport> report = ippe->Solve(scene.problem);
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_EQ(report->alternatives.size(), 1U);
  EXPECT_GT(RotationDistance(report->alternatives[0].rotation, report->cam_from_lidar.rotation),
            0.01);
}

}  // namespace
}  // namespace sextant
