// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/random.h"
#include "base/simd.h"
#include "features/camera/undistortion.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

// Pixels anywhere on and around a tag of 60 px; their number does not fill the last SIMD vector.
EdgePixels SomePixels() {
  Random random(1);
  EdgePixels pixels;
  constexpr std::size_t kCount = 203;
  const std::size_t padded = (kCount + kSimdWidth - 1) / kSimdWidth * kSimdWidth;
  for (std::size_t i = 0; i < padded; ++i) {
    pixels.x.push_back(random.Uniform(-40.0, 40.0));
    pixels.y.push_back(random.Uniform(-40.0, 40.0));
    pixels.x_by_u.push_back(1.02);
    pixels.x_by_v.push_back(0.03);
    pixels.y_by_u.push_back(-0.02);
    pixels.y_by_v.push_back(0.97);
    pixels.grey.push_back(random.Uniform(0.0, 255.0));
  }
  pixels.count = kCount;
  return pixels;
}

TagState SomeState() {
  TagState state;
  state.tag_from_straight << 0.03, 0.008, 0.01, -0.006, 0.031, 0.02, 0.0004, -0.0003, 1.0;
  state.blur_px = 0.9;
  state.gain = {150.0, 5.0, -8.0};
  state.offset = {30.0, 2.0, 3.0};
  return state;
}

TagState Moved(TagState state, int unknown, double step) {
  Eigen::Matrix3d change = Eigen::Matrix3d::Identity();
  if (unknown < 8) change(unknown / 3, unknown % 3) += step;
  state.tag_from_straight = change * state.tag_from_straight;
  if (unknown == kTagBlur) state.blur_px *= std::exp(step);
  if (unknown >= kTagGain && unknown < kTagOffset) state.gain[unknown - kTagGain] += step;
  if (unknown >= kTagOffset) state.offset[unknown - kTagOffset] += step;
  return state;
}

// The derivative by the blur neglects the correlation of a skewed blur, and the derivatives by the
// homography neglect the change of the blur's shape: both by some percent of the largest.
TEST(TagModel, NormalEquationsAreThoseOfItsOwnDifferences) {
  const EdgePixels pixels = SomePixels();
  TagModel model(*MakeTagPattern("tag36h11", 4), pixels);
  Eigen::Matrix<double, Eigen::Dynamic, kTagUnknowns> rows(pixels.count, kTagUnknowns);
  constexpr double kStep = 1e-4;
  for (int k = 0; k < kTagUnknowns; ++k) {
    model.Evaluate(Moved(SomeState(), k, -kStep));
    const Eigen::VectorXd before = model.residuals();
    model.Evaluate(Moved(SomeState(), k, kStep));
    rows.col(k) = (before - model.residuals()) / (2.0 * kStep);
  }
  model.Evaluate(SomeState());
  TagNormal normal;
  TagRow right;
  constexpr double kMax = 40.0;
  model.Linearise(kMax, normal, right);
  const Eigen::VectorXd weights = (kMax / model.residuals().array().abs().max(1e-12)).min(1.0);
  const TagNormal expected = rows.transpose() * weights.asDiagonal() * rows;
  const TagRow expected_right = rows.transpose() * weights.cwiseProduct(model.residuals());
  for (int a = 0; a < kTagUnknowns; ++a) {
    for (int b = 0; b < kTagUnknowns; ++b) {
      EXPECT_NEAR(normal(a, b), expected(a, b), 0.03 * std::sqrt(expected(a, a) * expected(b, b)))
          << a << " " << b;
    }
    const double size = std::sqrt(expected(a, a)) * model.residuals().norm();
    EXPECT_NEAR(right[a], expected_right[a], 0.03 * size) << a;
  }
}

// Across an edge of the border, far from its ends, the grey level follows the normal distribution
// function.
TEST(TagModel, AnEdgeRisesAsTheNormalDistribution) {
  EdgePixels pixels;
  for (std::size_t i = 0; i < 2 * kSimdWidth; ++i) {
    pixels.x.push_back(-104.0 + 0.5 * static_cast<double>(i));
    pixels.y.push_back(5.0);
    pixels.x_by_u.push_back(1.0);
    pixels.x_by_v.push_back(0.0);
    pixels.y_by_u.push_back(0.0);
    pixels.y_by_v.push_back(1.0);
    pixels.grey.push_back(0.0);
  }
  pixels.count = 2 * kSimdWidth;
  TagState state;
  state.tag_from_straight = Eigen::Vector3d(0.01, 0.01, 1.0).asDiagonal();
  state.blur_px = 1.3;
  state.gain.x() = 1.0;
  TagModel model(*MakeTagPattern("tag36h11", 4), pixels);
  model.Evaluate(state);
  for (Eigen::Index i = 0; i < pixels.count; ++i) {
    const double h = (-100.0 - pixels.x[static_cast<std::size_t>(i)]) / state.blur_px;
    EXPECT_NEAR(-model.residuals()[i], 0.5 * std::erfc(-h / std::numbers::sqrt2), 4e-5);
  }
}

TEST(Undistortion, FromANearbyPixelIsAsAccurate) {
  for (const char* name : {"pinhole", "zed_left", "point_grey", "fisheye"}) {
    const Camera camera = *FindCameraModel(name);
    const Undistortion undistortion(camera);
    Random random(2);
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector2d from(random.Uniform(0.2, 0.8) * camera.width_px,
                                 random.Uniform(0.2, 0.8) * camera.height_px);
      Eigen::Vector2d step;
      for (int k = 0; k < 2; ++k) step[k] = random.Uniform(-8.0, 8.0);
      const auto start = undistortion.Undistort(from);
      const auto truth = undistortion.Undistort(from + step);
      ASSERT_TRUE(start && truth) << name;
      const auto near = undistortion.UndistortNear(from + step, from, *start);
      ASSERT_TRUE(near) << name;
      EXPECT_LT((near->straight_px - truth->straight_px).norm(), 1e-4) << name;
      EXPECT_LT((near->straight_by_pixel - truth->straight_by_pixel).norm(), 1e-3) << name;
    }
  }
}

}  // namespace
}  // namespace sextant
