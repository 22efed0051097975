// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tags/tag_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "features/camera/tags/apriltag_family.h"
#include "features/camera/tags/aruco_dictionary.h"
#include "features/camera/tags/opencv_aruco.h"

namespace sextant::test {
namespace {

std::vector<std::uint8_t> ArucoCells(const std::string& family, int id) {
  const cv::Mat marker = DrawArucoCells(*FindArucoDictionary(family), id, ArucoBorderCells(family));
  std::vector<std::uint8_t> white;
  for (const std::uint8_t level : cv::Mat_<std::uint8_t>(marker)) white.push_back(level > 127);
  return white;
}

std::vector<std::uint8_t> AprilTagCells(apriltag_family_t* family, int id) {
  const AprilTagImage image = DrawAprilTag(*family, id);
  std::vector<std::uint8_t> white;
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) white.push_back(image->buf[y * image->stride + x] > 127);
  }
  return white;
}

class TagPatternTest : public testing::TestWithParam<std::string> {};

TEST_P(TagPatternTest, IsWhatTheLibraryDraws) {
  const Expected<int> count = TagCount(GetParam());
  ASSERT_TRUE(count);
  for (const int id : {0, *count / 2, *count - 1}) {
    const Expected<TagPattern> pattern = MakeTagPattern(GetParam(), id);
    ASSERT_TRUE(pattern);
    const bool aruco = FindArucoDictionary(GetParam()).has_value();
    EXPECT_EQ(pattern->white, aruco ? ArucoCells(GetParam(), id)
                                    : AprilTagCells(MakeAprilTagFamily(GetParam()).get(), id));
    EXPECT_EQ(pattern->white.size(), static_cast<std::size_t>(pattern->cells * pattern->cells));
  }
}

// Detectors report the corners of the outer border of a ring of cells of one colour: the outermost
// cells of the square have one colour, those around it the other.
TEST_P(TagPatternTest, ReportsTheSquareBetweenTwoRingsOfOneColourEach) {
  const TagPattern pattern = *MakeTagPattern(GetParam(), 0);
  const int first = pattern.edge_first;
  const int last = first + pattern.edge_cells - 1;
  EXPECT_EQ(first + last, pattern.cells - 1);
  const bool inside = pattern.IsWhite(first, first);
  for (int i = first; i <= last; ++i) {
    EXPECT_EQ(pattern.IsWhite(first, i), inside);
    EXPECT_EQ(pattern.IsWhite(last, i), inside);
    EXPECT_EQ(pattern.IsWhite(i, first), inside);
    EXPECT_EQ(pattern.IsWhite(i, last), inside);
  }
  if (first == 0) {
    EXPECT_FALSE(inside) << "the board around it is white";
    return;
  }
  for (int i = first - 1; i <= last + 1; ++i) {
    EXPECT_NE(pattern.IsWhite(first - 1, i), inside);
    EXPECT_NE(pattern.IsWhite(last + 1, i), inside);
    EXPECT_NE(pattern.IsWhite(i, first - 1), inside);
    EXPECT_NE(pattern.IsWhite(i, last + 1), inside);
  }
}

TEST_P(TagPatternTest, RefusesIdsThatTheFamilyDoesNotHave) {
  const int count = *TagCount(GetParam());
  for (const int id : {-1, count}) {
    const Expected<TagPattern> pattern = MakeTagPattern(GetParam(), id);
    ASSERT_FALSE(pattern);
    EXPECT_EQ(pattern.error().code, ErrorCode::kInvalidInput);
    EXPECT_THAT(pattern.error().message, testing::HasSubstr(std::to_string(count - 1)));
  }
}

INSTANTIATE_TEST_SUITE_P(Families, TagPatternTest, testing::ValuesIn(TagFamilies()),
                         [](const auto& family) { return family.param; });

TEST(TagPatternTest, SuggestsTheNearestFamily) {
  const Expected<TagPattern> pattern = MakeTagPattern("tag36h12", 0);
  ASSERT_FALSE(pattern);
  EXPECT_EQ(pattern.error().code, ErrorCode::kUnknownName);
  EXPECT_THAT(pattern.error().message, testing::HasSubstr("tag36h11"));
}

}  // namespace
}  // namespace sextant::test
