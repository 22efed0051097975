// SPDX-License-Identifier: Apache-2.0
#include "report/hidden_returns.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

}  // namespace
}  // namespace sextant
