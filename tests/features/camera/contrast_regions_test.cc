// SPDX-License-Identifier: Apache-2.0
#include "features/camera/contrast_regions.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <string_view>

#include "base/random.h"
#include "features/camera/tag_detector.h"
#include "features/camera/tags/tag_pattern.h"
#include "support/grey_noise.h"

namespace sextant {
namespace {

using test::AddNoise;

constexpr int kWidth = 1280;
constexpr int kHeight = 720;
constexpr int kWall_grey = 150;

cv::Mat Wall() { return {kHeight, kWidth, CV_8U, cv::Scalar(kWall_grey)}; }

// A printed tag with a white margin of one cell, its upper left corner at `at`.
void Paste(const std::string& family, int id, int cell_px, const cv::Point& at, cv::Mat& image,
           int black = 30, int white = 210) {
  const TagPattern pattern = *MakeTagPattern(family, id);
  const int side = (pattern.cells + 2) * cell_px;
  cv::rectangle(image, cv::Rect(at, cv::Size(side, side)), white, cv::FILLED);
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) {
      if (pattern.IsWhite(row, column)) continue;
      const cv::Point corner = at + cv::Point(column + 1, row + 1) * cell_px;
      cv::rectangle(image, cv::Rect(corner, cv::Size(cell_px, cell_px)), black, cv::FILLED);
    }
  }
}

TEST(ContrastRegions, NoiseGivesNoneAndTextureTheWholeImage) {
  cv::Mat wall = Wall();
  EXPECT_TRUE(ContrastRegions(wall).empty());
  AddNoise(wall, 3.0, 1);
  EXPECT_TRUE(ContrastRegions(wall).empty());
  AddNoise(wall, 40.0, 2);
  const std::vector<cv::Rect> all = ContrastRegions(wall);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_EQ(all[0], cv::Rect(0, 0, kWidth, kHeight));
}

TEST(ContrastRegions, ContainPartsWithContrastAndAMarginAndAreDisjoint) {
  Random random(3);
  for (int trial = 0; trial < 50; ++trial) {
    cv::Mat wall = Wall();
    std::vector<cv::Rect> spots;
    for (int i = 0; i < 4; ++i) {
      const int side = 8 + static_cast<int>(random.Uniform(0.0, 60.0));
      const int x = static_cast<int>(random.Uniform(0.0, kWidth - side));
      const int y = static_cast<int>(random.Uniform(0.0, kHeight - side));
      spots.emplace_back(x, y, side, side);
      cv::rectangle(wall, spots.back(), kWall_grey - 40, cv::FILLED);
    }
    const std::vector<cv::Rect> regions = ContrastRegions(wall);
    for (const cv::Rect& spot : spots) {
      const cv::Rect room =
          (spot + cv::Size(64, 64) - cv::Point(32, 32)) & cv::Rect(0, 0, kWidth, kHeight);
      EXPECT_TRUE(std::ranges::any_of(regions, [&](const cv::Rect& region) {
        return (region & room) == room;
      })) << spot;
    }
    for (std::size_t i = 0; i < regions.size(); ++i) {
      EXPECT_EQ(regions[i].x % 16, 0);
      EXPECT_EQ(regions[i].y % 16, 0);
      for (std::size_t j = 0; j < i; ++j) EXPECT_EQ((regions[i] & regions[j]).area(), 0);
    }
  }
}

TEST(ContrastRegions, ASmallImageIsOneRegion) {
  const cv::Mat image(100, 300, CV_8U, cv::Scalar(7));
  ASSERT_EQ(ContrastRegions(image).size(), 1U);
  EXPECT_EQ(ContrastRegions(image)[0].area(), 100 * 300);
}

// Tags from three pixels per cell up to half the image, including faint ones.
TEST(ContrastRegions, TheyContainEveryTag) {
  for (const char* spec : {"apriltag(family=tag36h11)", "apriltag(family=tag36h11,decimate=2)",
                           "aruco(dictionary=tag36h11)"}) {
    const TagDetectorPtr detector = *MakeTagDetector(spec);
    for (const int cell_px : {3, 4, 6, 10, 20, 35}) {
      if (cell_px < 4 && std::string_view(spec).find("decimate=2") != std::string_view::npos) {
        continue;  // The library itself does not see these in half the image.
      }
      cv::Mat wall = Wall();
      Paste("tag36h11", 5, cell_px, {203, 107}, wall);
      Paste("tag36h11", 9, cell_px, {801, 251}, wall, 120, 180);
      AddNoise(wall, 2.0, 4);
      const Expected<Detections> found = detector->Detect(wall);
      ASSERT_TRUE(found) << found.error().message;
      ASSERT_EQ(found->tags.size(), 2U) << spec << " " << cell_px;
      EXPECT_EQ(found->tags[0].id, 5);
      EXPECT_EQ(found->tags[1].id, 9);
      const TagPattern pattern = *MakeTagPattern("tag36h11", 5);
      const double from = (1.0 + pattern.edge_first) * cell_px - 0.5;
      double least = 1e9;
      for (const Eigen::Vector2d& corner : found->tags[0].corners_px) {
        least = std::min(least, (corner - Eigen::Vector2d(203.0 + from, 107.0 + from)).norm());
      }
      EXPECT_LT(least, 1.0) << spec << " " << cell_px;
    }
  }
}

// Noise is not traced (MinRange in apriltag_detector.cc), but tags with a contrast of four sigma
// are found: the library itself loses the first ones at three and a half.
TEST(ContrastRegions, NoTagIsLostToTheNoise) {
  for (const char* spec : {"apriltag(family=tag36h11)", "apriltag(family=tag36h11,decimate=2)"}) {
    const TagDetectorPtr detector = *MakeTagDetector(spec);
    for (const int sigma_grey : {3, 5}) {
      constexpr int kColumns = 8;
      constexpr int kRows = 4;
      cv::Mat wall = Wall();
      for (int id = 0; id < kColumns * kRows; ++id) {
        const cv::Point at(20 + 155 * (id % kColumns), 20 + 170 * (id / kColumns));
        Paste("tag36h11", id, 9, at, wall, kWall_grey - 4 * sigma_grey, kWall_grey);
      }
      AddNoise(wall, sigma_grey, 5);
      const Expected<Detections> found = detector->Detect(wall);
      ASSERT_TRUE(found) << found.error().message;
      EXPECT_GE(found->tags.size(), 31U) << spec << " " << sigma_grey;
    }
  }
}

}  // namespace
}  // namespace sextant
