// SPDX-License-Identifier: Apache-2.0
#include "io/results/check_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sextant {
namespace {

CheckResult SomeCheck() {
  CheckResult check{.version = "1",
                    .pose_path = "result.yaml",
                    .read_as = "cam_from_lidar",
                    .read_by = "as --pose-is states",
                    .state = "moved",
                    .is_certain = true,
                    .reason = "moved by 1.2 deg",
                    .cam_from_lidar = {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.1, 0.2, 0.3}},
                    .pairs = {{"7", "photo_7.png", "scan_7.pcd"}},
                    .detect_rad = 0.01,
                    .detect_m = 0.08};
  check.camera = Camera{.fx_px = 700, .fy_px = 700, .cx_px = 640, .cy_px = 360};
  check.change << 0.02, 0.0, 0.0, 0.01, 0.0, 0.0;
  check.sigma = Vector6d::Constant(1e-3);
  return check;
}

TEST(CheckResult, RoundTripsToTheSameText) {
  CheckResult check = SomeCheck();
  for (const bool has_sigma : {true, false}) {
    if (!has_sigma) check.sigma.reset();
    const std::string text = FormatCheckResult(check);
    EXPECT_TRUE(IsCheckResult(text));
    const Expected<CheckResult> read = ParseCheckResult(text, "check.json");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->sigma.has_value(), has_sigma);
    EXPECT_EQ(read->pairs.size(), 1U);
    EXPECT_EQ(read->read_as, check.read_as);
    EXPECT_EQ(read->read_by, check.read_by);
    EXPECT_TRUE(read->is_certain);
    EXPECT_LT((read->change - check.change).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_LT((read->cam_from_lidar.translation - check.cam_from_lidar.translation).norm(), 1e-15);
  }
}

TEST(CheckResult, OtherJsonIsRefused) {
  EXPECT_FALSE(IsCheckResult("{\"sextant_rig_result\": 1}"));
  const Expected<CheckResult> read = ParseCheckResult("{\"a\": 1}", "a.json");
  ASSERT_FALSE(read);
  EXPECT_THAT(read.error().message, testing::HasSubstr("sextant_check"));
}

}  // namespace
}  // namespace sextant
