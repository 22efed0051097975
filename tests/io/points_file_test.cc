// SPDX-License-Identifier: Apache-2.0
#include "io/problems/points_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "solvers/kernels/kabsch.h"
#include "support/bad_text.h"
#include "support/real_data.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::BadText;

TEST(PointsFile, RoundTripsToTheBit) {
  Random random(1);
  const CalibrationProblem problem = test::MakeScene({.pairs = 9, .sigma_m = 0.01}, random).problem;
  const std::string text = FormatPoints(problem.pairs_3d3d);
  const Expected<CalibrationProblem> read = ParsePoints(text, "points.txt");
  ASSERT_TRUE(read) << read.error().message;
  ASSERT_EQ(read->pairs_3d3d.size(), 9U);
  for (std::size_t i = 0; i < 9; ++i) {
    EXPECT_EQ(read->pairs_3d3d[i].point_in_cam, problem.pairs_3d3d[i].point_in_cam);
    EXPECT_EQ(read->pairs_3d3d[i].point_in_lidar, problem.pairs_3d3d[i].point_in_lidar);
    EXPECT_EQ(read->pairs_3d3d[i].id, problem.pairs_3d3d[i].id);
  }
  EXPECT_EQ(read->point_sets.in_cam, problem.point_sets.in_cam);
  EXPECT_EQ(FormatPoints(read->pairs_3d3d), text);
}

TEST(PointsFile, TakesLineEndsMarksAndBlanksOfEveryKind) {
  const char* forms[] = {
      "1\n1 2 3\n4 5 6\n",
      "1\n1 2 3\n4 5 6",
      "1\r\n1 2 3\r\n4 5 6\r\n",
      "\357\273\2771\n\n  1\t 2   3 \n\n4 +5 6e0\n\n",
      "# by hand\n1\n1 2 3\n# camera\n4 5 6\n",
  };
  for (const char* form : forms) {
    const Expected<CalibrationProblem> read = ParsePoints(form, "p");
    ASSERT_TRUE(read) << form << read.error().message;
    EXPECT_EQ(read->pairs_3d3d[0].point_in_lidar, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(read->pairs_3d3d[0].point_in_cam, Eigen::Vector3d(4, 5, 6));
  }
}

class BadPointsTest : public testing::TestWithParam<BadText> {};

TEST_P(BadPointsTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParsePoints(GetParam().text, "points.txt"), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadPointsTest,
    testing::Values(
        BadText{"Empty", "", ErrorCode::kParse, "points.txt:1: the file ends here"},
        BadText{"Blank", " \n\r\n", ErrorCode::kParse, "expected the number of points"},
        BadText{"CountOnly", "2\n", ErrorCode::kParse, "LiDAR point 1 of 2"},
        BadText{"Truncated", "2\n1 2 3\n4 5 6\n7 8 9\n", ErrorCode::kParse,
                "points.txt:4: the file ends here, expected x y z of camera point 2 of 2 (m)"},
        BadText{"TruncatedInALine", "1\n1 2 3\n4 5\n", ErrorCode::kParse,
                "points.txt:3: expected x y z of camera point 1 of 1 (m), got 2 fields"},
        BadText{"DecimalComma", "1\n1 0,5 3\n4 5 6\n", ErrorCode::kParse,
                "points.txt:2: field 2: expected a number, got '0,5' (decimal comma? use a "
                "point)"},
        BadText{"Word", "1\n1 2 x3\n4 5 6\n", ErrorCode::kParse, "field 3: expected a number"},
        BadText{"HalfNumber", "1\n1 2 3m\n4 5 6\n", ErrorCode::kParse, "got '3m'"},
        BadText{"NotANumber", "1\n1 nan 3\n4 5 6\n", ErrorCode::kNonFinite,
                "points.txt:2: field 2: expected a finite number, got 'nan'"},
        BadText{"Infinite", "1\n1 2 3\n4 -inf 6\n", ErrorCode::kNonFinite, "got '-inf'"},
        BadText{"Overflow", "1\n1 2 1e999\n4 5 6\n", ErrorCode::kNonFinite, "got '1e999'"},
        BadText{"ZeroCount", "0\n", ErrorCode::kParse, "got '0'"},
        BadText{"NegativeCount", "-8\n", ErrorCode::kParse, "got '-8'"},
        BadText{"RealCount", "8.0\n", ErrorCode::kParse, "expected a whole number"},
        BadText{"HugeCount", "1000000000000\n1 2 3\n", ErrorCode::kParse,
                "points.txt:2: the file ends here, expected x y z of LiDAR point 2 of"},
        BadText{"CountBeyondIntegers", "99999999999999999999999\n1 2 3\n", ErrorCode::kParse,
                "expected a whole number"},
        BadText{"TooManyRows", "1\n1 2 3\n4 5 6\n7 8 9\n", ErrorCode::kParse,
                "points.txt:4: expected the end of the file"},
        BadText{"NoCount", "1 2 3\n4 5 6\n", ErrorCode::kParse, "the number of points alone"},
        BadText{"Binary",
                std::string("\x7f"
                            "ELF\x02\x01\x00\xff\xfe",
                            9),
                ErrorCode::kParse, "got '\\x7fELF\\x02\\x01\\x00\\xff\\xfe'"},
        BadText{"LongToken", "1\n1 2 " + std::string(100'000, '9') + "x\n", ErrorCode::kParse,
                "9999..."}),
    [](const auto& bad) { return bad.param.name; });

TEST(PointsFile, RealFileGivesThePublishedFit) {
  SEXTANT_REAL_DATA(path, "dhall/points_head.txt");
  const Expected<CalibrationProblem> problem = ReadPoints(path);
  ASSERT_TRUE(problem) << problem.error().message;
  const PointSets points = PointsOf(problem->pairs_3d3d);
  ASSERT_EQ(points.in_cam.size(), 8U);
  const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
  ASSERT_TRUE(fit);
  const Eigen::Vector3d expected(0.07782465, -0.12717874, -0.13056974);
  EXPECT_LT((fit->b_from_a.translation - expected).norm(), 1e-7);
  EXPECT_NEAR(std::sqrt(fit->sum_squares / 8.0), 0.03914974, 1e-7);
}

}  // namespace
}  // namespace sextant
