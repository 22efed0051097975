// SPDX-License-Identifier: Apache-2.0
// The original package's small files: configuration, boards, detected markers, logs, poses.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/boards/marker_files.h"
#include "io/original/average_log.h"
#include "io/original/original_config.h"
#include "io/problems/points_file.h"
#include "io/problems/transform_list.h"
#include "support/bad_text.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::BadText;

using ErrorCode::kParse;

const std::string kConfig =
    "1280 720\n-2.5 2.5\n-4.0 4.0\n0.0 2.5\n0.05\n2\n0\n"
    "600 0 640 0\n0 700 360 0\n0 0 1 0\n";

TEST(OriginalConfig, TakesEachFormByItsCount) {
  const Expected<OriginalConfig> plain = ParseOriginalConfig(kConfig, "c");
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_EQ(plain->width_px, 1280);
  EXPECT_EQ(plain->y_range_m[1], 4.0);
  EXPECT_EQ(plain->projection(1, 2), 360.0);
  EXPECT_FALSE(plain->use_camera_info);
  EXPECT_FALSE(plain->max_iterations || plain->initial_rotation_rad || plain->lidar_type);

  const auto rotated = ParseOriginalConfig(kConfig + "100\n0.1 0.2 0.3\n", "c");
  ASSERT_TRUE(rotated);
  EXPECT_EQ(rotated->max_iterations, 100);
  EXPECT_EQ(*rotated->initial_rotation_rad, Eigen::Vector3d(0.1, 0.2, 0.3));
  EXPECT_FALSE(rotated->initial_translation_m || rotated->lidar_type);

  const auto typed = ParseOriginalConfig(kConfig + "100\n0.1 0.2 0.3\n1\n", "c");
  ASSERT_TRUE(typed);
  EXPECT_EQ(typed->lidar_type, 1);
  EXPECT_FALSE(typed->initial_translation_m);

  const auto moved = ParseOriginalConfig(kConfig + "100\n0.1 0.2 0.3\n4 5 6\n", "c");
  ASSERT_TRUE(moved);
  EXPECT_EQ(*moved->initial_translation_m, Eigen::Vector3d(4, 5, 6));
  EXPECT_FALSE(moved->lidar_type);

  const auto all = ParseOriginalConfig(kConfig + "100\n1.5707963267948966 0 0\n4 5 6\n0\n", "c");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->lidar_type, 0);
  const Eigen::Vector3d turned = all->InitialPose() * Eigen::Vector3d(0, 1, 0);
  EXPECT_LT((turned - Eigen::Vector3d(4, 5, 7)).norm(), 1e-14);
}

class BadConfigTest : public testing::TestWithParam<BadText> {};

TEST_P(BadConfigTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParseOriginalConfig(GetParam().text, "c.txt"), GetParam());
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadConfigTest,
    testing::Values(
        BadText{"Empty", "", kParse, "c.txt:1: the file ends here, expected width"},
        BadText{"Truncated", kConfig.substr(0, 60), kParse, "expected P("},
        BadText{"Count24", kConfig + "100\n", kParse, "expected initial rotation x"},
        BadText{"Count29", kConfig + "100\n1 2 3\n1 1\n", kParse,
                "expected 23, 27, 28, 30 or 31 numbers in the file, got 29"},
        BadText{"Count32", kConfig + "100\n1 2 3\n4 5 6\n1\n9\n", kParse, "got 32"},
        BadText{"Range", "640 480\n2 -2\n", kParse, "c.txt:2: expected x- <= x+, got 2 and -2"},
        BadText{"Word", "640 high\n", kParse, "c.txt:1: field 2 (height): expected a whole number"},
        BadText{"NotANumber", "640 480\n-1 nan\n", ErrorCode::kNonFinite, "field 2 (x+)"},
        BadText{"Binary", std::string("\0\1\2", 3), kParse, "'\\x00\\x01\\x02'"}),
    [](const auto& bad) { return bad.param.name; });

TEST(OriginalConfig, ReadsEveryRealVariant) {
  SEXTANT_REAL_DATA(path, "dhall/config_variants");
  const bool has_pose[] = {true, true, true, false, true, true, false};
  const bool has_translation[] = {true, true, true, false, false, false, false};
  const bool has_type[] = {false, true, true, false, true, false, false};
  for (std::size_t i = 0; i < 7; ++i) {
    const auto config = ReadOriginalConfig(path / ("0" + std::to_string(i) + ".txt"));
    ASSERT_TRUE(config) << config.error().message;
    EXPECT_EQ(config->initial_rotation_rad.has_value(), has_pose[i]) << i;
    EXPECT_EQ(config->initial_translation_m.has_value(), has_translation[i]) << i;
    EXPECT_EQ(config->lidar_type.has_value(), has_type[i]) << i;
    EXPECT_EQ(config->markers, i == 1 ? 1 : 2);
  }
}

TEST(MarkerCoordinates, RealBoardsHaveTheEdgesOfTheRealPoints) {
  SEXTANT_REAL_DATA(path, "dhall/session_2017-05-03");
  const auto markers = ReadMarkerCoordinates(path / "marker_coordinates.txt");
  ASSERT_TRUE(markers) << markers.error().message;
  const std::vector<Board> boards = BoardsOf(*markers);
  ASSERT_EQ(boards.size(), 2U);
  EXPECT_DOUBLE_EQ((*markers)[0].marker_m, 0.205);
  const auto points = ReadPoints(path / "points.txt");
  ASSERT_TRUE(points);
  for (std::size_t i = 0; i < 8; ++i) {
    const std::size_t next = i / 4 * 4 + (i + 1) % 4;
    const double edge_m =
        (points->pairs_3d3d[next].point_in_cam - points->pairs_3d3d[i].point_in_cam).norm();
    // Points and the pose from which they were computed are printed to six digits.
    EXPECT_NEAR(edge_m, boards[i / 4].EdgeLengths()[i % 4], 2e-5) << i;
  }
}

TEST(MarkerCoordinates, RefusesBadText) {
  const BadText cases[] = {
      {"empty", "", kParse, "m:1: the file ends here, expected the number of boards"},
      {"truncated", "1\n1\n2\n3\n4\n", kParse, "m:5: the file ends here, expected e"},
      {"huge", "1000000000\n1\n", kParse, "expected a whole number from 1 to 1000"},
      {"negative", "1\n1\n-2\n3\n4\n5\n", kParse, "m:3: expected s2 >= 0 cm"},
      {"trailing", "1\n1\n2\n3\n4\n5\n6\n", kParse, "m:7: expected the end of the file"},
  };
  for (const BadText& bad : cases) ExpectRefused(ParseMarkerCoordinates(bad.text, "m"), bad);
}

TEST(DetectedMarkers, ReadsTheRealSession) {
  SEXTANT_REAL_DATA(path, "dhall/session_2017-05-03/transform.txt");
  const auto markers = ReadDetectedMarkers(path);
  ASSERT_TRUE(markers) << markers.error().message;
  ASSERT_EQ(markers->size(), 2U);
  EXPECT_EQ((*markers)[1].id, 582);
  EXPECT_EQ((*markers)[0].corners_px[3], Eigen::Vector2d(520.07, 163.066));
  EXPECT_EQ((*markers)[0].translation_m, Eigen::Vector3d(-0.304563, -0.453048, 1.78202));
  EXPECT_EQ((*markers)[1].rotation_rad, Eigen::Vector3d(-0.521003, 1.89845, -1.82292));
}

TEST(DetectedMarkers, RefusesBadText) {
  const std::string tail = " (3,4) (5,6) (7,8) Txyz=1 2 3 Rxyz=4 5 6\n";
  const BadText cases[] = {
      {"empty", "", kParse, "t:1: the file ends here"},
      {"short", "26=(1,2) (3,4)\n", kParse, "expected id=(u,v)"},
      {"no id", "(1,2)" + tail, kParse, "field 1 (id): expected a whole number"},
      {"no equals", "26" + tail, kParse, "t:1: "},
      {"no bracket", "26=1,2" + tail, kParse, "expected a corner (u,v), got '1,2'"},
      {"word", "26=(1,x)" + tail, kParse, "field 1 (v): expected a number, got 'x'"},
      {"name", "26=(1,2) (3,4) (5,6) (7,8) Rxyz=1 2 3 Txyz=4 5 6", kParse, "expected Txyz=x y z"},
      {"nan", "26=(1,2) (3,4) (5,6) (7,8) Txyz=1 nan 3 Rxyz=4 5 6", ErrorCode::kNonFinite, "(y)"},
  };
  for (const BadText& bad : cases) ExpectRefused(ParseDetectedMarkers(bad.text, "t"), bad);
}

TEST(AverageLog, ReadsTheRealLog) {
  SEXTANT_REAL_DATA(path, "dhall/avg_values_head.txt");
  const auto rows = ReadAverageLog(path);
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 100U);
  EXPECT_EQ(rows->back().iteration, 100);
  EXPECT_EQ(rows->back().mean_translation_m, Eigen::Vector3d(0.0812551, -0.126682, -0.141122));
  EXPECT_EQ(rows->back().rotation(2, 0), -0.42270762);
  EXPECT_EQ(rows->back().rmse_m, 0.04073882);
}

TEST(AverageLog, RefusesBadText) {
  const std::string good = "1\n0\n0\n0\n1 0 0\n0 1 0\n0 0 1\n0.1\n";
  EXPECT_TRUE(ParseAverageLog(good, "a"));
  const BadText cases[] = {
      {"empty", "", kParse, "a:1: the file ends here, expected the number of iteration 1"},
      {"truncated", good + "2\n0\n0\n", kParse, "a:11: the file ends here, expected a line of"},
      {"gap", good + "3\n", kParse, "a:9: field 1 (iteration): expected 2, got '3'"},
      {"mirror", "1\n0\n0\n0\n1 0 0\n0 1 0\n0 0 -1\n0.1\n", kParse, "a:7: expected three rows"},
      {"rmse", "1\n0\n0\n0\n1 0 0\n0 1 0\n0 0 1\n-1\n", kParse, "a:8: expected an RMSE"},
      {"nan", "1\n0\nnan\n", ErrorCode::kNonFinite, "a:3: field 1"},
  };
  for (const BadText& bad : cases) ExpectRefused(ParseAverageLog(bad.text, "a"), bad);
}

TEST(TransformList, ReadsTheRealPair) {
  SEXTANT_REAL_DATA(path, "dhall/rts.txt");
  const auto transforms = ReadTransformList(path);
  ASSERT_TRUE(transforms) << transforms.error().message;
  ASSERT_EQ(transforms->size(), 2U);
  EXPECT_EQ((*transforms)[1].translation, Eigen::Vector3d(0.257, -0.23, -0.22));
}

TEST(TransformList, RefusesBadText) {
  const BadText cases[] = {
      {"empty", "", kParse, "r:1: the file ends here, expected row 1 of 4"},
      {"three rows", "1 0 0 0\n0 1 0 0\n0 0 1 0\n", kParse, "r:3: the file ends here"},
      {"scaled", "2 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n", kParse, "r:4: expected a rotation"},
      {"last row", "1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 1 1\n", kParse, "r:4: expected a rotation"},
      {"3x4", "1 0 0\n", kParse, "r:1: expected row 1 of 4 of a 4x4 matrix, got 3 fields"},
      {"inf", "1 0 0 inf\n", ErrorCode::kNonFinite, "r:1: field 4"},
  };
  for (const BadText& bad : cases) ExpectRefused(ParseTransformList(bad.text, "r"), bad);
}

}  // namespace
}  // namespace sextant
