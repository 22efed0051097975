// SPDX-License-Identifier: Apache-2.0
#include "geometry/camera.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <vector>

#include "base/random.h"

namespace sextant {
namespace {

Camera PlainCamera(CameraModel model) {
  return {.model = model,
          .width_px = 1280,
          .height_px = 720,
          .fx_px = 700.0,
          .fy_px = 710.0,
          .cx_px = 639.5,
          .cy_px = 359.5};
}

// Coefficients in the range of calibrations of real lenses.
Camera RandomCamera(CameraModel model, Random& random) {
  Camera camera = PlainCamera(model);
  auto& k = camera.distortion;
  if (model == CameraModel::kBrownConrady) {
    k[0] = random.Uniform(-0.35, 0.2);
    k[1] = random.Uniform(-0.05, 0.15);
    k[2] = random.Uniform(-2e-3, 2e-3);
    k[3] = random.Uniform(-2e-3, 2e-3);
    k[4] = random.Uniform(-0.02, 0.02);
    if (random.Below(2) == 0) {
      for (const std::size_t i : {5U, 6U, 7U}) k[i] = random.Uniform(-0.1, 0.3);
    }
    if (random.Below(2) == 0) {
      for (std::size_t i = 8; i < 12; ++i) k[i] = random.Uniform(-3e-3, 3e-3);
      for (std::size_t i = 12; i < 14; ++i) k[i] = random.Uniform(-0.03, 0.03);
      camera.skew_px = random.Uniform(-5.0, 5.0);
    }
  } else if (model == CameraModel::kEquidistant) {
    for (std::size_t i = 0; i < 4; ++i) k[i] = random.Uniform(-0.05, 0.05);
  } else if (model == CameraModel::kOmnidirectional) {
    camera.xi = random.Uniform(0.0, 2.0);
    for (const std::size_t i : {0U, 1U}) k[i] = random.Uniform(-0.1, 0.2);
    for (const std::size_t i : {2U, 3U}) k[i] = random.Uniform(-2e-3, 2e-3);
  } else if (model == CameraModel::kDoubleSphere) {
    camera.xi = random.Uniform(-0.4, 1.0);
    camera.alpha = random.Uniform(0.0, 0.8);
  }
  return camera;
}

Eigen::Vector3d RandomPoint(Random& random) {
  const double z = random.Uniform(0.5, 20.0);
  const double x = z * random.Uniform(-1.2, 1.2);
  const double y = z * random.Uniform(-0.8, 0.8);
  return {x, y, z};
}

class CameraModels : public testing::TestWithParam<CameraModel> {};

TEST_P(CameraModels, JacobianIsTheDerivativeOfTheProjection) {
  Random random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const Camera camera = RandomCamera(GetParam(), random);
    const Eigen::Vector3d point = RandomPoint(random);
    const auto analytic = ProjectWithJacobian(camera, point);
    ASSERT_EQ(analytic.has_value(), Project(camera, point).has_value());
    if (!analytic) continue;
    EXPECT_EQ(analytic->pixel, *Project(camera, point));
    const double step = 1e-6 * point.z();
    for (int axis = 0; axis < 3; ++axis) {
      const auto ahead = Project(camera, point + step * Eigen::Vector3d::Unit(axis));
      const auto behind = Project(camera, point - step * Eigen::Vector3d::Unit(axis));
      if (!ahead || !behind) continue;  // Across the border of the domain.
      const Eigen::Vector2d numeric = (*ahead - *behind) / (2.0 * step);
      EXPECT_LT((numeric - analytic->pixel_by_point.col(axis)).norm() * point.z(), 1e-4);
    }
  }
}

TEST_P(CameraModels, UnprojectInvertsProject) {
  Random random(2);
  int projected = 0;
  for (int trial = 0; trial < 5000; ++trial) {
    const Camera camera = RandomCamera(GetParam(), random);
    const Eigen::Vector3d point = RandomPoint(random);
    const auto pixel = ProjectWithJacobian(camera, point);
    if (!pixel) continue;
    ++projected;
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, pixel->pixel);
    ASSERT_TRUE(ray);
    EXPECT_NEAR(ray->norm(), 1.0, 1e-15);
    // Near the fold the ray is ill-conditioned: compare pixels.
    EXPECT_LT((*Project(camera, *ray) - pixel->pixel).norm(), 1e-10);
    const Eigen::Matrix2d by_plane = point.z() * pixel->pixel_by_point.leftCols<2>();
    if (by_plane.determinant() < 0.1 * camera.fx_px * camera.fy_px) continue;
    EXPECT_LT((*ray - point.normalized()).norm(), 1e-13);
  }
  EXPECT_GT(projected, 3000);
}

TEST_P(CameraModels, RefusesPointsBehindTheCamera) {
  const Camera camera = PlainCamera(GetParam());
  std::vector<double> depths = {std::numeric_limits<double>::quiet_NaN()};
  const bool is_wide = GetParam() == CameraModel::kEquidistant;
  if (!is_wide) depths.insert(depths.end(), {-2.0, -0.0, 0.0});
  for (const double z : depths) {
    EXPECT_FALSE(Project(camera, {0.1, 0.2, z}));
    EXPECT_FALSE(ProjectWithJacobian(camera, {0.1, 0.2, z}));
  }
}

TEST_P(CameraModels, CentreIsOnTheAxis) {
  Camera camera = PlainCamera(GetParam());
  const bool has_distortion =
      GetParam() != CameraModel::kPinhole && GetParam() != CameraModel::kDoubleSphere;
  if (has_distortion) camera.distortion[0] = -0.1;
  EXPECT_EQ(*Unproject(camera, {639.5, 359.5}), Eigen::Vector3d::UnitZ());
  const auto centre = ProjectWithJacobian(camera, {0.0, 0.0, 2.0});
  ASSERT_TRUE(centre);
  EXPECT_EQ(centre->pixel, Eigen::Vector2d(639.5, 359.5));
  EXPECT_DOUBLE_EQ(centre->pixel_by_point(0, 0), 350.0);
  EXPECT_DOUBLE_EQ(centre->pixel_by_point(1, 1), 355.0);
}

INSTANTIATE_TEST_SUITE_P(All, CameraModels,
                         testing::Values(CameraModel::kPinhole, CameraModel::kBrownConrady,
                                         CameraModel::kEquidistant, CameraModel::kOmnidirectional,
                                         CameraModel::kDoubleSphere));

// Pixels computed once by cv::projectPoints and cv::fisheye::projectPoints of OpenCV 4.6.
TEST(Project, AgreesWithOpenCv) {
  using Pixels = std::array<Eigen::Vector2d, 3>;
  const std::array<Eigen::Vector3d, 3> points = {
      Eigen::Vector3d(0.8, -0.5, 2.0), {-1.1, 0.7, 1.9}, {0.05, 0.02, 1.0}};
  const auto expect = [&](CameraModel model, const std::array<double, kMaxDistortion>& k,
                          const Pixels& expected) {
    Camera camera = PlainCamera(model);
    camera.distortion = k;
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_LT((*Project(camera, points[i]) - expected[i]).norm(), 1e-11) << i;
    }
  };
  expect(CameraModel::kBrownConrady, {-0.28, 0.09, 0.0012, -0.0007},
         {Eigen::Vector2d(902.869732500000, 192.662857656250),
          {278.667232344103, 592.653431573616},
          {674.469415491500, 373.690638747980}});
  expect(CameraModel::kBrownConrady, {-0.28, 0.09, 0.0012, -0.0007, -0.011},
         {Eigen::Vector2d(902.835805866875, 192.684364718320),
          {279.132770163282, 592.352948072146},
          {674.469415482110, 373.690638744170}});
  expect(CameraModel::kBrownConrady, {0.31, -0.12, 0.0012, -0.0007, 0.02, 0.52, -0.08, 0.03},
         {Eigen::Vector2d(906.775300364013, 190.187006599599),
          {269.161352671488, 598.789044816849},
          {674.476514315537, 373.693518842303}});
  expect(CameraModel::kEquidistant, {-0.03, 0.012, -0.004, 0.0009},
         {Eigen::Vector2d(899.716040214779, 194.541617363846),
          {287.678525720243, 586.584769762389},
          {674.463192733460, 373.685066766147}});
}

// x (1 - x^2) has its maximum at x = 1 / sqrt(3), and changes sign beyond x = 1.
TEST(CameraDomain, EndsWhereTheImageStopsGrowing) {
  Camera camera = PlainCamera(CameraModel::kBrownConrady);
  camera.distortion[0] = -1.0;
  const double fold = 1.0 / std::sqrt(3.0);
  EXPECT_TRUE(Project(camera, {fold - 1e-6, 0.0, 1.0}));
  EXPECT_FALSE(Project(camera, {fold + 1e-6, 0.0, 1.0}));
  EXPECT_FALSE(Project(camera, {2.0, 0.0, 1.0}));
  const double border_px = 700.0 * fold * (1.0 - fold * fold);
  EXPECT_TRUE(Unproject(camera, {639.5 + border_px - 1e-3, 359.5}));
  EXPECT_FALSE(Unproject(camera, {639.5 + border_px + 1e-3, 359.5}));
}

// The radius decreases between r = 0.71 and 1.29 and then grows again: no radius beyond is in the
// domain.
TEST(CameraDomain, DoesNotReturnBehindTheFold) {
  Camera camera = PlainCamera(CameraModel::kBrownConrady);
  // 1 + 3 k1 s + 5 k2 s^2 = (1 - s / 0.5) (1 - s / 1.66)
  camera.distortion[0] = -(1.0 / 0.5 + 1.0 / 1.66) / 3.0;
  camera.distortion[1] = 1.0 / (0.5 * 1.66) / 5.0;
  EXPECT_TRUE(Project(camera, {std::sqrt(0.5) - 1e-6, 0.0, 1.0}));
  for (const double r : {std::sqrt(0.5) + 1e-6, 1.0, 1.3, 2.0, 5.0}) {
    EXPECT_FALSE(Project(camera, {r, 0.0, 1.0})) << r;
  }
}

TEST(CameraDomain, EndsAtAPoleOfTheRationalModel) {
  Camera camera = PlainCamera(CameraModel::kBrownConrady);
  camera.distortion[5] = -1.0;  // r / (1 - r^2)
  // Its slope (1 + s) / (1 - s)^2 is 10 at s = r^2 = 0.6: from there on it runs away.
  EXPECT_TRUE(Project(camera, {std::sqrt(0.6) - 1e-6, 0.0, 1.0}));
  EXPECT_FALSE(Project(camera, {std::sqrt(0.6) + 1e-6, 0.0, 1.0}));
  EXPECT_FALSE(Project(camera, {1.0, 0.0, 1.0}));
  EXPECT_FALSE(Project(camera, {1.5, 0.0, 1.0}));
  EXPECT_NEAR(Unproject(camera, {639.5 + 700.0 * 0.6 / 0.64, 359.5})->x(), 0.6 / std::hypot(0.6, 1),
              1e-14);
}

TEST(CameraDomain, FisheyeEndsAtItsFoldOrStraightBack) {
  Camera camera = PlainCamera(CameraModel::kEquidistant);
  EXPECT_TRUE(Project(camera, {1e3, 0.0, 1.0}));
  EXPECT_TRUE(Project(camera, {1.0, 0.0, 0.0}));
  EXPECT_TRUE(Project(camera, {0.1, 0.2, -2.0}));
  EXPECT_FALSE(Project(camera, {0.0, 0.0, -2.0}));
  EXPECT_FALSE(Project(camera, {0.0, 0.0, 0.0}));
  EXPECT_TRUE(Unproject(camera, {639.5 + 700.0 * 3.14, 359.5}));
  EXPECT_FALSE(Unproject(camera, {639.5 + 700.0 * 3.15, 359.5}));
  camera.distortion[0] = -1.0 / 3.0;  // Maximum at 1 rad.
  EXPECT_TRUE(Project(camera, {std::tan(1.0 - 1e-6), 0.0, 1.0}));
  EXPECT_FALSE(Project(camera, {std::tan(1.0 + 1e-6), 0.0, 1.0}));
  EXPECT_TRUE(Unproject(camera, {639.5, 359.5 + 710.0 * 0.666}));
  EXPECT_FALSE(Unproject(camera, {639.5, 359.5 + 710.0 * 0.667}));
}

TEST(ValidateCamera, AcceptsRealCalibrations) {
  Random random(3);
  for (int trial = 0; trial < 200; ++trial) {
    for (const CameraModel model :
         {CameraModel::kPinhole, CameraModel::kBrownConrady, CameraModel::kEquidistant}) {
      const Expected<void> ok = ValidateCamera(RandomCamera(model, random));
      EXPECT_TRUE(ok) << ok.error().message;
    }
  }
}

TEST(ValidateCamera, RefusesImpossibleLenses) {
  const auto code = [](auto&& spoil) {
    Camera camera = PlainCamera(CameraModel::kBrownConrady);
    spoil(camera);
    const Expected<void> ok = ValidateCamera(camera);
    return ok ? ErrorCode::kIo : ok.error().code;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code([&](Camera& c) { c.cx_px = nan; }), ErrorCode::kNonFinite);
  EXPECT_EQ(code([&](Camera& c) { c.distortion[7] = 1.0 / 0.0; }), ErrorCode::kNonFinite);
  EXPECT_EQ(code([](Camera& c) { c.fx_px = 0.0; }), ErrorCode::kInvalidInput);
  EXPECT_EQ(code([](Camera& c) { c.fy_px = -700.0; }), ErrorCode::kInvalidInput);
  EXPECT_EQ(code([](Camera& c) { c.height_px = -1; }), ErrorCode::kInvalidInput);
  EXPECT_EQ(code([](Camera& c) { c.distortion[0] = -30.0; }), ErrorCode::kInvalidInput);
  EXPECT_EQ(code([](Camera& c) { c.distortion[5] = -30.0; }), ErrorCode::kInvalidInput);
  EXPECT_EQ(code([](Camera& c) {
              c.model = CameraModel::kPinhole;
              c.distortion[0] = -0.1;
            }),
            ErrorCode::kInvalidInput);
  EXPECT_EQ(code([](Camera& c) {
              c = {.fx_px = 700.0, .fy_px = 700.0};
              c.model = CameraModel::kEquidistant;
              c.distortion[0] = -1000.0;
            }),
            ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace sextant
