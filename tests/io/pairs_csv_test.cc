// SPDX-License-Identifier: Apache-2.0
#include "io/problems/pairs_csv.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/bad_text.h"
#include "support/scenes.h"

namespace sextant {
namespace {

using test::BadText;

using ErrorCode::kParse;

TEST(PairsCsv, RoundTripsBothKindsToTheBit) {
  Random random(1);
  const CalibrationProblem problem =
      test::MakeScene({.pairs = 7, .sigma_m = 0.01, .sigma_px = 0.3}, random).problem;
  const std::string pixels = FormatPairsCsv(problem.pairs_2d3d);
  const std::string points = FormatPairsCsv(problem.pairs_3d3d);
  const Expected<CalibrationProblem> from_pixels = ParsePairsCsv(pixels, "p.csv");
  const Expected<CalibrationProblem> from_points = ParsePairsCsv(points, "p.csv");
  ASSERT_TRUE(from_pixels) << from_pixels.error().message;
  ASSERT_TRUE(from_points) << from_points.error().message;
  ASSERT_EQ(from_pixels->pairs_2d3d.size(), 7U);
  EXPECT_EQ(from_pixels->pairs_2d3d[6].pixel, problem.pairs_2d3d[6].pixel);
  EXPECT_EQ(from_pixels->pairs_2d3d[6].sigma_px, 0.3);
  EXPECT_EQ(from_pixels->pairs_2d3d[6].id, problem.pairs_2d3d[6].id);
  EXPECT_EQ(FormatPairsCsv(from_pixels->pairs_2d3d), pixels);
  EXPECT_EQ(FormatPairsCsv(from_points->pairs_3d3d), points);
  EXPECT_EQ(from_points->point_sets.in_cam, problem.point_sets.in_cam);
}

TEST(PairsCsv, TakesColumnsInAnyOrderAndEveryFormOfId) {
  const Expected<CalibrationProblem> read = ParsePairsCsv(
      "\xef\xbb\xbfid, x, y, z, v, u\r\n7, 1, 2, 3, 5, 4\r\n26:1,1,2,3,5,4\r\n3:26:2,1,2,3,5,4\r\n",
      "p");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->pairs_2d3d[0].pixel, Eigen::Vector2d(4, 5));
  EXPECT_EQ(read->pairs_2d3d[0].id, (PairId{.view = 0, .board = 7, .corner = 0}));
  EXPECT_EQ(read->pairs_2d3d[1].id, (PairId{.view = 0, .board = 26, .corner = 1}));
  EXPECT_EQ(read->pairs_2d3d[2].id, (PairId{.view = 3, .board = 26, .corner = 2}));
  const Expected<CalibrationProblem> plain = ParsePairsCsv("u,v,x,y,z\n1,2,3,4,5\n1,2,3,4,5", "p");
  EXPECT_EQ(plain->pairs_2d3d[1].id, (PairId{.view = 0, .board = 1, .corner = 0}));
}

class BadCsvTest : public testing::TestWithParam<BadText> {};

TEST_P(BadCsvTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParsePairsCsv(GetParam().text, "p.csv"), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadCsvTest,
    testing::Values(
        BadText{"Empty", "", kParse, "p.csv:1: the file ends here, expected a header line"},
        BadText{"HeaderOnly", "u,v,x,y,z\n", kParse, "expected rows of 5 values (u,v,x,y,z)"},
        BadText{"MissingColumn", "u,v,x,y\n", kParse,
                "p.csv:1: expected the columns u,v,x,y,z; z is missing"},
        BadText{"UnknownColumn", "u,v,x,y,z,sigma_pix\n", kParse, "did you mean 'sigma_px'?"},
        BadText{"RepeatedColumn", "u,v,x,y,z,u\n", kParse, "the column 'u' appears twice"},
        BadText{"BothKinds", "u,v,x,y,z,camx\n", kParse, "belongs to the other kind"},
        BadText{"SigmaOfTheOther", "camx,camy,camz,lidarx,lidary,lidarz,sigma_px\n", kParse,
                "sigma_px belongs to the other kind"},
        BadText{"BoardWithoutCorner", "u,v,x,y,z,board\n", kParse, "board and corner"},
        BadText{"TwoIds", "u,v,x,y,z,id,board,corner\n", kParse, "either id, or view"},
        BadText{"ShortRow", "u,v,x,y,z\n1,2,3,4\n", kParse,
                "p.csv:2: expected 5 values (u,v,x,y,z), got 4 fields"},
        BadText{"EmptyField", "u,v,x,y,z\n1,2,,4,5\n", kParse,
                "p.csv:2: field 3 (x): expected a number, got ''"},
        BadText{"DecimalComma", "u,v,x,y,z\n1,5,2,3,4,5\n", kParse, "got 6 fields"},
        BadText{"NotANumber", "u,v,x,y,z\n1,2,3,4,NaN\n", ErrorCode::kNonFinite,
                "p.csv:2: field 5 (z): expected a finite number, got 'NaN'"},
        BadText{"NegativeSigma", "u,v,x,y,z,sigma_px\n1,2,3,4,5,-1\n", kParse,
                "expected sigma_px >= 0, got -1"},
        BadText{"BadId", "u,v,x,y,z,id\n1,2,3,4,5,a:b\n", kParse, "field 6 (id)"},
        BadText{"LongId", "u,v,x,y,z,id\n1,2,3,4,5,1:2:3:4\n", kParse, "field 6 (id)"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace sextant
