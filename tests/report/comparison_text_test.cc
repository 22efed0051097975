// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "report/report_text.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::Not;

ScoredRow RowWith(std::optional<PoseDistance> from_truth) {
  SolveReport report;
  report.solver = "drop_worst(kabsch,keep=6)";
  report.inliers = {0, 1};
  report.evaluation.rmse_m = 0.00365;
  report.evaluation.per_pair_m = {0.003, 0.004, 0.004};
  report.evaluation.rmse_px = 1.054;
  report.evaluation.per_pair_px = {1.0, 1.1, 1.0};
  report.wall_time_us = 1078880.8;
  const PoseDistance apart{.rotation_rad = 2.2, .translation_m = 3.06497};
  return {.row = {report.solver, report, apart, from_truth}, .score = 2.297};
}

std::size_t Width(const std::string& text) {
  std::size_t longest = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    longest = std::max(longest, end - begin);
    begin = end + 1;
  }
  return longest;
}

// Where the truth is known, the distance to it is worth more than that to the best answer.
TEST(Comparison, OfBothKindsOfPairsWithATruthHasAtMost100Columns) {
  const std::string without = DescribeComparison({RowWith({})});
  EXPECT_LE(Width(without), 100U) << without;
  EXPECT_THAT(without, HasSubstr("to first [mm]"));
  const std::string with = DescribeComparison({RowWith(PoseDistance{0.0063, 0.01459})});
  EXPECT_LE(Width(with), 100U) << with;
  EXPECT_THAT(with, HasSubstr("error [mm]"));
  EXPECT_THAT(with, Not(HasSubstr("to first")));
}

}  // namespace
}  // namespace sextant
