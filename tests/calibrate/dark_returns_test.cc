// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/dark_returns.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"

namespace sextant {
namespace {

constexpr double kBlackExcess_m = 0.014;
constexpr double kFarFace_m = 2.0;

struct PrintedFace {
  FaceOfBoard face;
  std::vector<float> intensity;
  std::vector<bool> dark;
};

// Ten rings across an upright board with cells of 10 cm; each ring has an offset of its own.
PrintedFace Print(double excess_m, bool is_printed) {
  Random random(3);
  PrintedFace print;
  for (int ring = 0; ring < 10; ++ring) {
    const double ring_offset = 0.01 * random.Normal();
    for (int column = 0; column < 60; ++column) {
      const double y = -0.3 + 0.01 * column;
      const double z = -0.3 + 0.06 * ring;
      const bool dark =
          is_printed &&
          (static_cast<int>(std::floor(10.0 * y)) + static_cast<int>(std::floor(10.0 * z))) % 2 ==
              0;
      const Eigen::Vector3d on_board(kFarFace_m, y, z);
      const double error = 0.009 * random.Normal();
      print.face.in_lidar.push_back(on_board + (ring_offset + error + (dark ? excess_m : 0.0)) *
                                                   on_board.normalized());
      print.face.rings.push_back(ring);
      const double noise = random.Normal();
      print.intensity.push_back(static_cast<float>((dark ? 3.0 : 50.0) + 3.0 * noise));
      print.dark.push_back(dark);
    }
  }
  return print;
}

LidarPlane UprightPlane() {
  LidarPlane plane;
  plane.normal = Eigen::Vector3d::UnitX();
  plane.origin = {kFarFace_m, 0.0, 0.0};
  plane.sigma_m = 0.01;
  return plane;
}

TEST(DarkReturns, AreMovedToTheRangeOfBrightOnes) {
  PrintedFace print = Print(kBlackExcess_m, true);
  const FaceOfBoard before = print.face;
  // 9 mm over 600 returns, half of them dark.
  constexpr double kSigma_m = 0.009 * 2.0 / 24.5;
  EXPECT_NEAR(CorrectDarkReturns(print.intensity, UprightPlane(), print.face), kBlackExcess_m,
              3.0 * kSigma_m);
  for (std::size_t i = 0; i < before.in_lidar.size(); ++i) {
    const double moved = (before.in_lidar[i] - print.face.in_lidar[i]).norm();
    if (print.dark[i]) {
      EXPECT_GT(moved, 0.009);
    } else {
      EXPECT_LT(moved, 0.004);
    }
  }
}

TEST(DarkReturns, StayWhereNothingIsPrintedOrTheSensorHasNoSuchError) {
  for (const bool is_printed : {false, true}) {
    PrintedFace print = Print(0.0, is_printed);
    const FaceOfBoard before = print.face;
    EXPECT_EQ(CorrectDarkReturns(print.intensity, UprightPlane(), print.face), 0.0);
    EXPECT_EQ(print.face.in_lidar, before.in_lidar);
  }
}

TEST(DarkReturns, NeedIntensities) {
  PrintedFace print = Print(kBlackExcess_m, true);
  EXPECT_EQ(CorrectDarkReturns({}, UprightPlane(), print.face), 0.0);
}

}  // namespace
}  // namespace sextant
