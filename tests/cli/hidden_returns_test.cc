// SPDX-License-Identifier: Apache-2.0
#include "report/hidden_returns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/random.h"

namespace sextant {
namespace {

// A near plate of returns, 10 pixels apart across and 20 down, from (200, 200) to (400, 400).
std::vector<ProjectedReturn> Plate() {
  std::vector<ProjectedReturn> returns;
  for (int v = 200; v <= 400; v += 20) {
    for (int u = 200; u <= 400; u += 10) {
      returns.push_back({.pixel = {u, v}, .range_m = 2.0, .distance_m = 2.0});
    }
  }
  return returns;
}

bool IsHidden(const Eigen::Vector2d& pixel, double distance_m) {
  std::vector<ProjectedReturn> returns = Plate();
  returns.push_back({.pixel = pixel, .range_m = distance_m, .distance_m = distance_m});
  return HiddenReturns(returns, {.across_px = 10.0, .down_px = 20.0}).back();
}

TEST(HiddenReturns, WhatLiesBehindAPlateIsAndWhatLiesBesideItIsNot) {
  EXPECT_TRUE(IsHidden({303.0, 307.0}, 4.0));   // In the middle, behind.
  EXPECT_TRUE(IsHidden({205.0, 307.0}, 4.0));   // Just inside its left side.
  EXPECT_FALSE(IsHidden({195.0, 307.0}, 4.0));  // Just outside of it.
  EXPECT_FALSE(IsHidden({303.0, 193.0}, 4.0));  // Just above it.
  EXPECT_FALSE(IsHidden({303.0, 307.0}, 2.1));  // On it, to the noise.
  EXPECT_FALSE(IsHidden({303.0, 307.0}, 1.0));  // Before it.
  EXPECT_FALSE(IsHidden({900.0, 307.0}, 4.0));
}

TEST(HiddenReturns, NoneOfAPlateHidesAnother) {
  const std::vector<ProjectedReturn> plate = Plate();
  EXPECT_THAT(HiddenReturns(plate, {.across_px = 10.0, .down_px = 20.0}),
              testing::Each(testing::Eq(false)));
  EXPECT_THAT(HiddenReturns({}, {}), testing::IsEmpty());
}

// The definition itself, pair by pair.
std::vector<bool> HiddenByDefinition(const std::vector<ProjectedReturn>& returns,
                                     const Eigen::Vector2d& window) {
  std::vector<bool> hidden;
  for (const ProjectedReturn& seen : returns) {
    std::array<bool, 4> quadrants{};
    for (const ProjectedReturn& other : returns) {
      const Eigen::Vector2d to = other.pixel - seen.pixel;
      if ((to.cwiseAbs().array() > window.array()).any()) continue;
      if (other.distance_m > 0.9 * seen.distance_m - 0.2) continue;
      quadrants[(to.x() > 0.0 ? 1U : 0U) + (to.y() > 0.0 ? 2U : 0U)] = true;
    }
    hidden.push_back(std::ranges::count(quadrants, true) >= 3);
  }
  return hidden;
}

TEST(HiddenReturns, AreThoseOfTheDefinition) {
  Random random(1);
  for (int trial = 0; trial < 30; ++trial) {
    // From few returns in a window to hundreds; on a grid, so that many coordinates are equal.
    const double step = trial % 3 == 0 ? 1.0 : 0.25;
    const double size = random.Uniform(20.0, 400.0);
    std::vector<ProjectedReturn> returns;
    for (int i = 0; i < 1500; ++i) {
      const double u = step * std::round(random.Uniform(-size, size) / step);
      const double v = step * std::round(random.Uniform(-size, size) / step);
      const double distance = random.Uniform(1.0, 6.0);
      returns.push_back({.pixel = {u, v}, .range_m = distance, .distance_m = distance});
    }
    const SampleSpacing spacing{.across_px = 4.0, .down_px = 10.0};
    EXPECT_EQ(HiddenReturns(returns, spacing), HiddenByDefinition(returns, {8.0, 20.0})) << trial;
  }
}

TEST(HiddenReturns, AMillionInOneWindowTakeNoQuadraticTime) {
  Random random(2);
  std::vector<ProjectedReturn> returns;
  for (int i = 0; i < 1'000'000; ++i) {
    const double u = random.Uniform(0.0, 100.0);
    const double v = random.Uniform(0.0, 100.0);
    const double distance = random.Uniform(1.0, 6.0);
    returns.push_back({.pixel = {u, v}, .range_m = distance, .distance_m = distance});
  }
  const std::vector<bool> hidden = HiddenReturns(returns, {.across_px = 50.0, .down_px = 50.0});
  // Nearly all that are more than 0.3 m behind the nearest, but for the corners of the picture.
  EXPECT_GT(std::ranges::count(hidden, true), 900'000);
}

}  // namespace
}  // namespace sextant
