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
