// SPDX-License-Identifier: Apache-2.0
// Fisheye, omnidirectional and double-sphere cameras up to the end of their domain, and the texts
// that name it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "geometry/camera.h"
#include "geometry/lens_domain.h"

namespace sextant {
namespace {

using testing::HasSubstr;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

Camera WideCamera(CameraModel model) {
  return {.model = model, .fx_px = 200.0, .fy_px = 210.0, .cx_px = 320.0, .cy_px = 240.0};
}

// Cameras of each wide model, from narrow to wider than 180 deg.
std::vector<Camera> WideCameras() {
  std::vector<Camera> cameras;
  for (const double xi : {0.0, 0.5, 1.0, 1.7}) {
    Camera camera = WideCamera(CameraModel::kOmnidirectional);
    camera.xi = xi;
    cameras.push_back(camera);
    camera.distortion = {-0.05, 0.01, 1e-4, -2e-4};
    camera.skew_px = 1.5;
    cameras.push_back(camera);
  }
  const std::array<double, 2> spheres[] = {{0.0, 0.0}, {-0.2, 0.55}, {0.1, 0.4}, {0.9, 0.7}};
  for (const auto& [xi, alpha] : spheres) {
    Camera camera = WideCamera(CameraModel::kDoubleSphere);
    camera.xi = xi;
    camera.alpha = alpha;
    cameras.push_back(camera);
  }
  cameras.push_back(WideCamera(CameraModel::kEquidistant));
  cameras.push_back(WideCamera(CameraModel::kEquidistant));
  cameras.back().distortion = {0.056743, -0.0048614, -0.00011769, -0.00029011};
  return cameras;
}

Eigen::Vector3d RayAt(double from_axis, double about_axis) {
  return {std::sin(from_axis) * std::cos(about_axis), std::sin(from_axis) * std::sin(about_axis),
          std::cos(from_axis)};
}

TEST(WideModels, UnprojectInvertsProjectOverTheWholeDomain) {
  Random random(1);
  for (const Camera& camera : WideCameras()) {
    ASSERT_TRUE(ValidateCamera(camera)) << ValidateCamera(camera).error().message;
    const double end = DomainEnd(camera);
    for (int trial = 0; trial < 500; ++trial) {
      const double from_axis = 0.99 * end * random.Uniform();
      const Eigen::Vector3d ray = RayAt(from_axis, random.Uniform(0.0, 6.28));
      const double distance = random.Uniform(0.1, 50.0);
      const auto pixel = Project(camera, distance * ray);
      ASSERT_TRUE(pixel) << from_axis / kRadPerDeg << " of " << end / kRadPerDeg;
      const auto back = Unproject(camera, *pixel);
      ASSERT_TRUE(back);
      EXPECT_NEAR(back->norm(), 1.0, 1e-14);
      // Where the image hardly grows any more, the pixel determines it less well. Near the end of a
      // domain without a border, pixels are up to 1e9, and their rounding with them.
      EXPECT_LT((*Project(camera, *back) - *pixel).norm(), 1e-9 + 1e-12 * pixel->norm());
      if (from_axis < 0.9 * end) {
        EXPECT_LT((*back - ray).norm(), 1e-11);
      }
    }
    EXPECT_FALSE(Project(camera, RayAt(std::min(1.001 * end, std::numbers::pi), 0.3)));
  }
}

TEST(WideModels, JacobianIsTheDerivativeBeyondNinetyDegreesToo) {
  Random random(2);
  for (const Camera& camera : WideCameras()) {
    const double end = DomainEnd(camera);
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector3d point =
          random.Uniform(0.5, 5.0) * RayAt(0.9 * end * random.Uniform(), random.Uniform(0.0, 6.28));
      const auto analytic = ProjectWithJacobian(camera, point);
      ASSERT_TRUE(analytic);
      EXPECT_EQ(analytic->pixel, *Project(camera, point));
      const double step = 1e-6 * point.norm();
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(axis);
        const Eigen::Vector2d numeric =
            (*Project(camera, point + shift) - *Project(camera, point - shift)) / (2.0 * step);
        const double scale = 1.0 + analytic->pixel_by_point.norm();
        EXPECT_LT((numeric - analytic->pixel_by_point.col(axis)).norm(), 1e-6 * scale);
      }
    }
  }
}

TEST(WideModels, LimitsArePinholeAndEquidistant) {
  Camera pinhole = WideCamera(CameraModel::kPinhole);
  Camera brown = WideCamera(CameraModel::kBrownConrady);
  Camera mei = WideCamera(CameraModel::kOmnidirectional);
  brown.distortion = mei.distortion = {-0.2, 0.05, 1e-3, -2e-3, 0.01};
  const Camera plain_mei = WideCamera(CameraModel::kOmnidirectional);
  const Camera sphere = WideCamera(CameraModel::kDoubleSphere);
  const Camera fisheye = WideCamera(CameraModel::kEquidistant);
  Random random(3);
  for (int trial = 0; trial < 100; ++trial) {
    const double from_axis = random.Uniform(0.0, 60.0) * kRadPerDeg;
    const double about_axis = random.Uniform(0.0, 6.28);
    const Eigen::Vector3d point = 2.0 * RayAt(from_axis, about_axis);
    const Eigen::Vector2d straight = *Project(pinhole, point);
    EXPECT_LT((*Project(plain_mei, point) - straight).norm(), 1e-11);
    EXPECT_LT((*Project(sphere, point) - straight).norm(), 1e-11);
    EXPECT_LT((*Project(mei, point) - *Project(brown, point)).norm(), 1e-11);
    const Eigen::Vector2d at = *Project(fisheye, point);
    EXPECT_NEAR(at.x(), 320.0 + 200.0 * from_axis * std::cos(about_axis), 1e-11);
    EXPECT_NEAR(at.y(), 240.0 + 210.0 * from_axis * std::sin(about_axis), 1e-11);
  }
}

// From the definitions, by hand: p = (1, 0, 0) is at 90 deg, so that d = 1.
TEST(WideModels, ValuesAtNinetyDegrees) {
  Camera camera = WideCamera(CameraModel::kOmnidirectional);
  camera.xi = 0.8;  // (1 / 0.8, 0)
  EXPECT_NEAR(Project(camera, {2.0, 0.0, 0.0})->x(), 320.0 + 200.0 / 0.8, 1e-11);
  camera = WideCamera(CameraModel::kDoubleSphere);
  camera.xi = 0.5;
  camera.alpha = 0.6;  // k = 0.5, d2 = sqrt(1.25).
  const double depth = 0.6 * std::sqrt(1.25) + 0.4 * 0.5;
  EXPECT_NEAR(Project(camera, {3.0, 0.0, 0.0})->x(), 320.0 + 200.0 / depth, 1e-11);
  EXPECT_NEAR(Project(WideCamera(CameraModel::kEquidistant), {3.0, 0.0, 0.0})->x(),
              320.0 + 100.0 * std::numbers::pi, 1e-11);
}

TEST(ThinPrismAndTilt, AnUprightSensorWithoutPrismIsAsBefore) {
  Camera camera = WideCamera(CameraModel::kBrownConrady);
  camera.distortion = {-0.1, 0.02, 1e-3, -1e-3, 0.0, 0.01};
  const Eigen::Vector2d before = *Project(camera, {0.3, -0.2, 1.0});
  camera.distortion[12] = 1e-12;
  camera.distortion[8] = 1e-12;
  EXPECT_LT((*Project(camera, {0.3, -0.2, 1.0}) - before).norm(), 1e-8);
}

// A tilt about x alone, by hand: with c = cos, s = sin, R = Rx, R33 = c, R13 = 0, R23 = s; the
// point (0, y, 1) goes to R (0, y, 1) = (0, c y + s, c - s y), then v = (c (c y + s) - s (c - s y))
// / (c - s y) = y / (c - s y).
TEST(ThinPrismAndTilt, TiltAboutXIsThatOfItsDefinition) {
  Camera camera = WideCamera(CameraModel::kBrownConrady);
  const double tilt = 0.2;
  camera.distortion[12] = tilt;
  const double y = 0.3;
  const double tilted = y / (std::cos(tilt) - std::sin(tilt) * y);
  EXPECT_NEAR(Project(camera, {0.0, y, 1.0})->y(), 240.0 + 210.0 * tilted, 1e-11);
}

TEST(LensDomain, NamesThePoleOfARationalDistortion) {
  Camera camera = WideCamera(CameraModel::kBrownConrady);
  camera.distortion = {2.9972164630889893,     -6.0928826332092285, 0.0005746248061768711,
                       -4.857033854932524e-05, -1.2618762254714966, 3.5340938568115234,
                       -4.270793914794922,     -5.302351951599121};
  EXPECT_THAT(DomainText(camera), HasSubstr("pole at r = 0.8088"));
  EXPECT_THAT(WhyNotProjected(camera, {0.83, 0.0, 1.0}), HasSubstr("at r = 0.83"));
  EXPECT_THAT(WhyNotProjected(camera, {0.83, 0.0, 1.0}), HasSubstr("pole at r = 0.8088"));
  EXPECT_THAT(WhyNotProjected(camera, {0.1, 0.0, -0.3}), HasSubstr("behind the camera (z = -0.3"));
  // The image beyond the pole continues that before it, and its pixels have no ray.
  EXPECT_TRUE(Unproject(camera, {320.0 + 200.0 * 0.598, 240.0}));
  EXPECT_FALSE(Unproject(camera, {320.0 + 200.0 * 0.6124, 240.0}));
}

TEST(LensDomain, NamesFoldsAndAngles) {
  Camera camera = WideCamera(CameraModel::kBrownConrady);
  camera.distortion[0] = -1.0;
  EXPECT_THAT(DomainText(camera), HasSubstr("folds the image at r = 0.5774, 30.0 deg"));
  camera = WideCamera(CameraModel::kEquidistant);
  camera.distortion[0] = -1.0 / 3.0;
  EXPECT_NEAR(DomainEnd(camera), 1.0, 1e-9);
  EXPECT_THAT(WhyNotProjected(camera, {1.0, 0.0, 0.0}),
              HasSubstr("90.0 deg from the axis, and the fisheye's polynomial grows up to 57.3"));
}

TEST(ValidateCamera, RefusesNumbersOfOtherModels) {
  const auto refuses = [](auto&& spoil) {
    Camera camera = WideCamera(CameraModel::kEquidistant);
    spoil(camera);
    const Expected<void> ok = ValidateCamera(camera);
    return !ok && ok.error().code == ErrorCode::kInvalidInput;
  };
  EXPECT_TRUE(refuses([](Camera& c) { c.xi = 0.5; }));
  EXPECT_TRUE(refuses([](Camera& c) { c.alpha = 0.5; }));
  EXPECT_TRUE(refuses([](Camera& c) { c.distortion[4] = 0.1; }));
  EXPECT_TRUE(refuses([](Camera& c) {
    c.model = CameraModel::kDoubleSphere;
    c.alpha = 1.2;
  }));
  EXPECT_TRUE(refuses([](Camera& c) {
    c.model = CameraModel::kOmnidirectional;
    c.xi = -0.1;
  }));
  EXPECT_TRUE(refuses([](Camera& c) {
    c.model = CameraModel::kPinhole;
    c.skew_px = 2.0;
  }));
}

}  // namespace
}  // namespace sextant
