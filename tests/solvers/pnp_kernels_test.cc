// SPDX-License-Identifier: Apache-2.0
// The algebraic kernels for pixels and points, epnp and sqpnp, with the same requirements.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <string>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"
#include "solvers/pnp/epnp.h"
#include "solvers/pnp/sqpnp.h"

namespace sextant {
namespace {

struct PointScene {
  std::vector<Eigen::Vector2d> image_points;
  std::vector<Eigen::Vector3d> points;
  Rigid3d cam_from_lidar;
};

struct Shape {
  std::string name;
  bool planar = false;
  double depth_m = 3.0;
};

// Points in a cube of side 2 m, or on a plane through it, `depth_m` in front of the camera.
PointScene MakePointScene(const Shape& shape, int count, double sigma, Random& random) {
  PointScene scene;
  const Eigen::Vector3d turn = UniformVector(random, 1.0);
  scene.cam_from_lidar.rotation =
      ExpSo3(turn * (std::numbers::pi / turn.norm()) * random.Uniform());
  scene.cam_from_lidar.translation = UniformVector(random, 0.5);
  const Rigid3d lidar_from_cam = scene.cam_from_lidar.Inverse();
  const Eigen::Quaterniond tilt = ExpSo3(UniformVector(random, 0.6));
  while (static_cast<int>(scene.points.size()) < count) {
    Eigen::Vector3d offset = UniformVector(random, 1.0);
    if (shape.planar) offset.z() = 0.0;
    const Eigen::Vector3d in_cam = tilt * offset + Eigen::Vector3d(0.1, -0.2, shape.depth_m);
    if (in_cam.z() < 0.1) continue;
    Eigen::Vector2d image_point = in_cam.hnormalized();
    for (int axis = 0; axis < 2; ++axis) image_point[axis] += sigma * random.Normal();
    scene.points.push_back(lidar_from_cam * in_cam);
    scene.image_points.push_back(image_point);
  }
  return scene;
}

// The inverse of the information of the image points on (dphi, dt).
Matrix6d CramerRaoBound(const PointScene& scene, double sigma) {
  Matrix6d information = Matrix6d::Zero();
  for (const Eigen::Vector3d& point : scene.points) {
    const Eigen::Vector3d arm = scene.cam_from_lidar.rotation * point;
    const Eigen::Vector3d in_cam = arm + scene.cam_from_lidar.translation;
    Eigen::Matrix<double, 2, 3> projection;
    projection << 1.0, 0.0, -in_cam.x() / in_cam.z(), 0.0, 1.0, -in_cam.y() / in_cam.z();
    Eigen::Matrix<double, 3, 6> motion;
    motion << -Hat(arm), Eigen::Matrix3d::Identity();
    const Eigen::Matrix<double, 2, 6> jacobian = projection * motion / in_cam.z();
    information += jacobian.transpose() * jacobian / (sigma * sigma);
  }
  return information.inverse();
}

struct Kernel {
  std::string name;
  Expected<Rigid3d> (*solve)(const PointScene&);
  double max_rms_ratio;  // To the Cramer-Rao bound, 1 px at f = 700 and 3 m.
};

const Kernel kKernels[] = {
    {"epnp",
     [](const PointScene& s) -> Expected<Rigid3d> {
       return SolveEpnp(s.image_points, s.points).map([](const EpnpFit& f) {
         return f.cam_from_lidar;
       });
     },
     1.25},
    {"sqpnp",
     [](const PointScene& s) -> Expected<Rigid3d> {
       return SolveSqpnp(s.image_points, s.points).map([](const SqpnpFit& f) {
         return f.cam_from_lidar[0];
       });
     },
     1.15},
};

const Shape kShapes[] = {
    {"cube", false, 3.0},        {"plane", true, 3.0},      {"deep_cube", false, 100.0},
    {"deep_plane", true, 100.0}, {"near_cube", false, 1.7}, {"near_plane", true, 1.2},
};

class PnpKernel : public testing::TestWithParam<Kernel> {};

class PnpKernelOnShape : public testing::TestWithParam<std::tuple<Kernel, Shape>> {};

TEST_P(PnpKernelOnShape, RecoversEveryExactPose) {
  const auto& [kernel, shape] = GetParam();
  for (const int count : {4, 5, 6, 8, 20, 1000}) {
    // Few points determine a pose worst; scenes of many take longest.
    const int trials = count < 100 ? 1000 : 50;
    Random random(DeriveSeed(1, shape.name, static_cast<std::uint64_t>(count), 0));
    int wrong = 0;
    for (int trial = 0; trial < trials; ++trial) {
      const PointScene scene = MakePointScene(shape, count, 0.0, random);
      const Expected<Rigid3d> pose = kernel.solve(scene);
      const double scale = std::max(1.0, shape.depth_m);
      if (!pose) {
        ++wrong;
        continue;
      }
      const PoseDistance error = DistanceBetween(*pose, scene.cam_from_lidar);
      if (!(error.rotation_rad < 1e-8 && error.translation_m < 1e-8 * scale)) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << count << " points";
  }
}

INSTANTIATE_TEST_SUITE_P(All, PnpKernelOnShape,
                         testing::Combine(testing::ValuesIn(kKernels), testing::ValuesIn(kShapes)),
                         [](const auto& test) {
                           return std::get<0>(test.param).name + "_" + std::get<1>(test.param).name;
                         });

TEST_P(PnpKernel, ErrorIsNearTheCramerRaoBound) {
  constexpr double kSigma = 1.0 / 700.0;
  constexpr int kTrials = 1000;
  for (const int count : {6, 8, 20, 100}) {
    Random random(DeriveSeed(2, "bound", static_cast<std::uint64_t>(count), 0));
    Eigen::Vector2d squares = Eigen::Vector2d::Zero();
    Eigen::Vector2d bound = Eigen::Vector2d::Zero();
    for (int trial = 0; trial < kTrials; ++trial) {
      const PointScene scene = MakePointScene({.name = "cube"}, count, kSigma, random);
      const Expected<Rigid3d> pose = GetParam().solve(scene);
      ASSERT_TRUE(pose) << pose.error().message;
      const Matrix6d limit = CramerRaoBound(scene, kSigma);
      const Vector6d error = PoseDifference(*pose, scene.cam_from_lidar);
      squares += Eigen::Vector2d(error.head<3>().squaredNorm(), error.tail<3>().squaredNorm());
      bound += Eigen::Vector2d(limit.topLeftCorner<3, 3>().trace(),
                               limit.bottomRightCorner<3, 3>().trace());
    }
    const Eigen::Array2d ratio = (squares.array() / bound.array()).sqrt();
    // Three standard errors of an RMS that is dominated by one squared normal per trial.
    const double tolerance = 3.0 / std::sqrt(2.0 * kTrials);
    EXPECT_LT(ratio.maxCoeff(), GetParam().max_rms_ratio + tolerance) << count << " points";
    EXPECT_GT(ratio.minCoeff(), 1.0 - tolerance) << count << " points";
  }
}

TEST_P(PnpKernel, RefusesSetsThatDoNotDetermineThePose) {
  Random random(3);
  const auto code = [](const PointScene& scene) {
    const Expected<Rigid3d> pose = GetParam().solve(scene);
    return pose ? "answered" : std::string(ToString(pose.error().code));
  };
  const PointScene good = MakePointScene({.name = "cube"}, 8, 0.0, random);
  EXPECT_EQ(code(good), "answered");

  PointScene few = good;
  few.points.resize(2);
  few.image_points.resize(2);
  EXPECT_EQ(code(few), "too_few_pairs");

  PointScene line = good;
  PointScene same_pixel = good;
  PointScene repeated = good;
  PointScene far = good;
  PointScene behind = good;
  for (std::size_t i = 0; i < good.points.size(); ++i) {
    const double along = static_cast<double>(i) * 0.1;
    line.points[i] = good.points[0] + along * (good.points[1] - good.points[0]);
    line.image_points[i] = (good.cam_from_lidar * line.points[i]).hnormalized();
    same_pixel.image_points[i] = good.image_points[0];
    repeated.points[i] = good.points[i % 2];
    repeated.image_points[i] = good.image_points[i % 2];
    far.points[i] = 1e12 * good.points[i];
    const Eigen::Vector3d mirrored = -(good.cam_from_lidar * good.points[i]);
    behind.points[i] = good.cam_from_lidar.Inverse() * mirrored;
  }
  EXPECT_EQ(code(line), "degenerate");
  EXPECT_EQ(code(same_pixel), "degenerate");
  EXPECT_EQ(code(repeated), "degenerate");
  EXPECT_EQ(code(far), "degenerate");
  EXPECT_EQ(code(behind), "mirrored");
}

TEST_P(PnpKernel, RefusesAnyNumberOfPointsBehindTheCamera) {
  Random random(4);
  for (int trial = 0; trial < 200; ++trial) {
    PointScene scene = MakePointScene({.name = "cube"}, 6 + trial % 20, 0.0, random);
    const Rigid3d lidar_from_cam = scene.cam_from_lidar.Inverse();
    for (Eigen::Vector3d& point : scene.points) {
      point = lidar_from_cam * Eigen::Vector3d(-(scene.cam_from_lidar * point));
    }
    const Expected<Rigid3d> pose = GetParam().solve(scene);
    ASSERT_FALSE(pose) << trial;
    EXPECT_EQ(pose.error().code, ErrorCode::kMirrored) << trial;
  }
}

TEST_P(PnpKernel, DoesNotMistakeNoiseForAMirrorImage) {
  Random random(7);
  int mirrored = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Shape shape{.name = "far_cube", .depth_m = 20.0};
    const PointScene scene = MakePointScene(shape, 4 + trial % 4, 1.0 / 700.0, random);
    const Expected<Rigid3d> pose = GetParam().solve(scene);
    if (!pose && pose.error().code == ErrorCode::kMirrored) ++mirrored;
  }
  // MirrorRatio: less than one in 10^5.
  EXPECT_EQ(mirrored, 0);
}

TEST_P(PnpKernel, DuplicatedPairsChangeNothingThatIsExact) {
  Random random(5);
  for (int trial = 0; trial < 200; ++trial) {
    PointScene scene = MakePointScene({.name = "cube"}, 4 + trial % 3, 0.0, random);
    for (const std::size_t i : {0U, 1U, 1U, 2U}) {
      scene.points.push_back(scene.points[i]);
      scene.image_points.push_back(scene.image_points[i]);
    }
    const Expected<Rigid3d> pose = GetParam().solve(scene);
    ASSERT_TRUE(pose) << pose.error().message;
    const PoseDistance error = DistanceBetween(*pose, scene.cam_from_lidar);
    EXPECT_LT(error.rotation_rad, 1e-8) << trial;
    EXPECT_LT(error.translation_m, 3e-8) << trial;
  }
}

INSTANTIATE_TEST_SUITE_P(All, PnpKernel, testing::ValuesIn(kKernels),
                         [](const auto& test) { return test.param.name; });

TEST(Sqpnp, GivesTheTruthAmongTheSolutionsOfThreePoints) {
  Random random(6);
  for (int trial = 0; trial < 1000; ++trial) {
    const PointScene scene = MakePointScene({.name = "cube"}, 3, 0.0, random);
    const Expected<SqpnpFit> fit = SolveSqpnp(scene.image_points, scene.points);
    ASSERT_TRUE(fit) << fit.error().message;
    double nearest = 1.0;
    for (int i = 0; i < fit->count; ++i) {
      const Rigid3d& pose = fit->cam_from_lidar[static_cast<std::size_t>(i)];
      nearest = std::min(nearest, DistanceBetween(pose, scene.cam_from_lidar).rotation_rad);
    }
    // Nearly merged solutions lose digits.
    EXPECT_LT(nearest, 1e-6) << trial;
  }
}

}  // namespace
}  // namespace sextant
