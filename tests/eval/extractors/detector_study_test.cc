// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/detector_study.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

constexpr int kTrials = 60;

const std::vector<DetectorRow>& Rows() {
  static const std::vector<DetectorRow> rows = [] {
    const auto studied = StudyDetectors({.trials = kTrials});
    EXPECT_TRUE(studied) << studied.error().message;
    return studied ? *studied : std::vector<DetectorRow>();
  }();
  return rows;
}

// Every setting of both libraries, converted to our pixel convention.
TEST(DetectorStudy, CornersAreUnbiasedAfterNormalisation) {
  ASSERT_EQ(Rows().size(), 13U);
  for (const DetectorRow& row : Rows()) {
    const double most = 0.05 + 3.0 * row.bias_sigma_px;
    EXPECT_LT(std::abs(row.shift_px.x()), most) << row.detector;
    EXPECT_LT(std::abs(row.shift_px.y()), most) << row.detector;
    EXPECT_LT(std::abs(row.inward_px), most) << row.detector;
    EXPECT_GT(row.found, kTrials / 2) << row.detector;
    // A missing half-pixel conversion would be detected.
    EXPECT_LT(most, 0.25) << row.detector;
  }
}

TEST(DetectorStudy, RefinedCornersHalveTheErrorOfTheBestSetting) {
  const DetectorRow& refined = Rows().back();
  ASSERT_EQ(refined.detector, "refined");
  double best = 1e9;
  for (std::size_t i = 0; i + 1 < Rows().size(); ++i) best = std::min(best, Rows()[i].rmse_px);
  EXPECT_LT(refined.rmse_px, 0.5 * best);
  EXPECT_LT(refined.rmse_px, 0.03);
  EXPECT_LT(refined.large_rmse_px, 0.02);
  // The mean over 60 tags of 8 numbers each has a standard error of sqrt(2 / 480) = 0.065.
  EXPECT_GT(refined.nees, 0.8);
  EXPECT_LT(refined.nees, 1.25);
}

TEST(DetectorStudy, TheSameSeedGivesTheSameTable) {
  const auto table = [] { return FormatDetectorStudy(*StudyDetectors({.trials = 3}), true); };
  EXPECT_EQ(table(), table());
}

TEST(DetectorStudy, RejectsFamiliesOfOneLibraryOnly) {
  EXPECT_FALSE(StudyDetectors({.trials = 1, .family = "tagStandard41h12"}));
}

}  // namespace
}  // namespace sextant
