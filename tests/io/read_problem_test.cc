// SPDX-License-Identifier: Apache-2.0
#include "io/problems/read_problem.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "support/real_data.h"

namespace sextant {
namespace {

using testing::HasSubstr;

TEST(ReadProblem, RecognisesTheFormatByTheContent) {
  const std::tuple<const char*, const char*, ProblemFormat> cases[] = {
      {"points.txt", "1\n1 2 3\n4 5 6\n", ProblemFormat::kPoints},
      {"points", "\xef\xbb\xbf\r\n1\r\n1 2 3\r\n4 5 6\r\n", ProblemFormat::kPoints},
      {"pairs.csv", "u,v,x,y,z\n1,2,3,4,5\n", ProblemFormat::kPairsCsv},
      {"pairs", "camx, camy, camz, lidarx, lidary, lidarz\n1,2,3,4,5,6\n",
       ProblemFormat::kPairsCsv},
      {"a.yaml", "sextant_problem: 1\n", ProblemFormat::kYaml},
      {"a.txt", "# by hand\nsextant_problem: 1\n", ProblemFormat::kYaml},
  };
  for (const auto& [file, text, format] : cases) {
    const Expected<DetectedProblem> read = ParseProblem(text, file);
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->format, format);
  }
}

TEST(ReadProblem, ListsTheFormatsIfNoneMatches) {
  for (const char* text : {"", "\n\n", "hello world\n", "1 2 3\n", "\x7f\x45LF", "%PDF-1.4"}) {
    const Expected<DetectedProblem> read = ParseProblem(text, "some.file");
    ASSERT_FALSE(read) << text;
    EXPECT_EQ(read.error().code, ErrorCode::kParse);
    EXPECT_THAT(read.error().message, HasSubstr("some.file:1: not a problem in a known format"));
    EXPECT_THAT(read.error().message, HasSubstr("points.txt"));
  }
}

TEST(ReadProblem, ReportsTheErrorOfTheMatchingFormat) {
  const std::pair<const char*, const char*> cases[] = {
      {"8\n", "expected x y z of LiDAR point 1 of 8"},
      {"u,v,x,y,w\n", "unknown column 'w'"},
      {"1,2,3\n", "expected x,y,z of the camera normal"},
      {"sextant_problem: 7\n", "got '7'"},
  };
  for (const auto& [text, message] : cases) {
    const Expected<DetectedProblem> read = ParseProblem(text, "f");
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message, HasSubstr(message));
  }
}

TEST(ReadProblem, RefusesCoordinatesAndNoiseOutOfRange) {
  const std::pair<std::string, const char*> cases[] = {
      {"2\n1 2 3\n1 2 1e10\n4 5 6\n7 8 9\n", "f: pairs, LiDAR frame: point 2 of 2: expected"},
      {"2\n0 0 0\n0 1e-10 0\n0 0 0\n1 0 0\n", "pairs, LiDAR frame: all 2 points are within 1e-10"},
      {"2\n0 0 0\n1 0 0\n0 0 0\n0 1e-160 0\n", "pairs, camera frame: all 2 points are within"},
      {"u,v,x,y,z\n1e10,2,3,4,5\n", "2D-3D pair 1: expected pixels up to 1e+09"},
      {"u,v,x,y,z,sigma_px\n1,2,3,4,5,1e-200\n", "2D-3D pair 1: expected a sigma from 1e-12"},
      {"sextant_problem: 1\npoint_sets:\n  in_cam: [[1, 2, 3e9]]\n  in_lidar: []\n",
       "f:3: in_cam: expected coordinates up to 1e+09 m"},
      {"sextant_problem: 1\ninitial_cam_from_lidar:\n  translation_m: [1e300, 0, 0]\n"
       "  quaternion_wxyz: [1, 0, 0, 0]\n",
       "f:3: translation_m: expected coordinates up to 1e+09 m"},
  };
  for (const auto& [text, message] : cases) {
    const Expected<DetectedProblem> read = ParseProblem(text, "f");
    ASSERT_FALSE(read) << text;
    EXPECT_THAT(read.error().message, HasSubstr(message));
  }
  EXPECT_TRUE(ParseProblem("2\n1 1 1\n1 1 1\n1 1 1\n1 1 1\n", "f")) << "solvers name this case";
}

TEST(ReadProblem, ReadsTheRealPoses) {
  SEXTANT_REAL_DATA(path, "acfr_vlp16/poses.csv");
  const Expected<DetectedProblem> read = ReadProblem(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->format, ProblemFormat::kAcfrPoses);
  EXPECT_EQ(read->problem.pairs_3d3d.size(), 160U);
}

TEST(ReadProblem, ReadsTheRealPoints) {
  SEXTANT_REAL_DATA(path, "dhall/points_head.txt");
  const Expected<DetectedProblem> read = ReadProblem(path);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->format, ProblemFormat::kPoints);
  EXPECT_EQ(read->problem.pairs_3d3d.size(), 8U);
}

TEST(ReadProblem, PointsALogOfAveragesToItsCommand) {
  const auto read = ParseProblem("1\n0.1\n-0.2\n0.3\n1 0 0\n0 1 0\n0 0 1\n0.03\n", "avg.txt");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kParse);
  EXPECT_THAT(read.error().message, testing::HasSubstr("avg.txt:1: "));
  EXPECT_THAT(read.error().message, testing::HasSubstr("sextant average"));
}

}  // namespace
}  // namespace sextant
