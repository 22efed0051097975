// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_detector.h"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <thread>

#include "features/camera/grey_image.h"
#include "features/camera/quad.h"
#include "features/camera/tags/tag_pattern.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using testing::HasSubstr;

constexpr int kCell_px = 12;
constexpr int kMargin_px = 40;

// A tag seen frontally, with cells of whole pixels, rotated clockwise by quarter turns.
cv::Mat Print(const TagPattern& pattern, int quarters = 0) {
  const int side = pattern.cells * kCell_px + 2 * kMargin_px;
  cv::Mat image(side, side, CV_8U, cv::Scalar(220));
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) {
      if (pattern.IsWhite(row, column)) continue;
      const cv::Point corner(kMargin_px + column * kCell_px, kMargin_px + row * kCell_px);
      cv::rectangle(image, cv::Rect(corner, cv::Size(kCell_px, kCell_px)), 20, cv::FILLED);
    }
  }
  for (int i = 0; i < quarters; ++i) cv::rotate(image, image, cv::ROTATE_90_CLOCKWISE);
  return image;
}

Quad CornersOfPrint(const TagPattern& pattern) {
  const double low = kMargin_px + pattern.edge_first * kCell_px - 0.5;
  const double high = low + pattern.edge_cells * kCell_px;
  return {Eigen::Vector2d(low, low), Eigen::Vector2d(high, low), Eigen::Vector2d(high, high),
          Eigen::Vector2d(low, high)};
}

class EveryFamily : public testing::TestWithParam<std::string> {};

// Id, orientation and pixels of every family by its own library, for every rotation of the tag.
TEST_P(EveryFamily, IsFoundWithItsOwnTopLeftFirst) {
  const std::string& family = GetParam();
  const TagDetectorPtr detector = *MakeTagDetector(*DetectorSpecFor(family));
  const int id = *TagCount(family) > 17 ? 17 : 3;
  const TagPattern pattern = *MakeTagPattern(family, id);
  const Quad upright = CornersOfPrint(pattern);
  for (std::size_t quarters = 0; quarters < 4; ++quarters) {
    const Expected<Detections> found = detector->Detect(Print(pattern, static_cast<int>(quarters)));
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->tags.size(), 1U);
    const TagDetection& tag = found->tags[0];
    EXPECT_EQ(tag.id, id);
    EXPECT_EQ(tag.family, family);
    EXPECT_EQ(tag.hamming, 0);
    EXPECT_GT(tag.decision_margin, 50.0);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_LT((tag.corners_px[k] - upright[(k + quarters) % 4]).norm(), 0.5) << k;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Families, EveryFamily, testing::ValuesIn(TagFamilies()),
                         [](const auto& family) { return family.param; });

// An error of half a pixel in the conversion from the decimated image would move the centre.
TEST(TagDetector, AReducedImageShowsTheTagWhereItIs) {
  const TagPattern pattern = *MakeTagPattern("aruco_6x6_250", 17);
  const Quad upright = CornersOfPrint(pattern);
  for (const int decimate : {1, 2, 4}) {
    const std::string spec = "aruco(dictionary=6x6_250,decimate=" + std::to_string(decimate) + ")";
    const Expected<Detections> found = (*MakeTagDetector(spec))->Detect(Print(pattern));
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->tags.size(), 1U) << spec;
    Eigen::Vector2d off = Eigen::Vector2d::Zero();
    for (std::size_t k = 0; k < 4; ++k) {
      off += 0.25 * (found->tags[0].corners_px[k] - upright[k]);
      EXPECT_LT((found->tags[0].corners_px[k] - upright[k]).norm(), 0.75 * decimate) << spec;
    }
    EXPECT_LT(off.norm(), 0.2) << spec;
  }
}

TEST(TagDetector, SpecsAreCheckedByName) {
  const auto message = [](const char* spec) {
    const Expected<TagDetectorPtr> made = MakeTagDetector(spec);
    return made ? std::string() : made.error().message;
  };
  EXPECT_THAT(message("foo"), HasSubstr("expected aruco, apriltag, checkerboard, with options"));
  EXPECT_THAT(message("tag36h11"), HasSubstr("did you mean 'apriltag(family=tag36h11)'?"));
  EXPECT_THAT(message("arco(dictionary=6x6_250)"), HasSubstr("did you mean 'aruco'?"));
  EXPECT_THAT(message("aruco(dictionary=6x6_25)"), HasSubstr("did you mean '6x6_250'?"));
  EXPECT_THAT(message("aruco(dictionry=6x6_250)"), HasSubstr("did you mean 'dictionary'?"));
  EXPECT_THAT(message("aruco"), HasSubstr("needs either a dictionary or the file of one"));
  EXPECT_THAT(message("aruco(dictionary=original,file=a.yml)"), HasSubstr("either"));
  EXPECT_THAT(message("aruco(file=/nowhere/a.yml)"), HasSubstr("/nowhere/a.yml"));
  EXPECT_THAT(message("apriltag(threads=0)"), HasSubstr("from 1 to 256"));
  EXPECT_THAT(message("apriltag(threads=1,threads=2)"), HasSubstr("given twice"));
  EXPECT_THAT(message("checkerboard(kabsch)"), HasSubstr("takes option=value"));
  EXPECT_THAT(message("apriltag(("), HasSubstr("column"));
  for (const TagDetectorEntry& entry : TagDetectorEntries()) {
    EXPECT_EQ(message(entry.example.c_str()), "");
  }
}

TEST(TagDetector, BrokenDictionariesAreRefused) {
  const auto path = (test::TestFolder() / "dictionary.yml").string();
  const auto code = [&path](const std::string& text) {
    test::WriteText(path, text);
    const auto made = MakeTagDetector("aruco(file=" + path + ")");
    return made ? std::string("none") : std::string(ToString(made.error().code));
  };
  const std::string head = "%YAML:1.0\nnmarkers: 1\nmarkersize: 3\nmaxCorrectionBits: 1\n";
  EXPECT_EQ(code(head + "marker_0: \"101010111\"\n"), "none");
  EXPECT_EQ(code(head + "marker_0: \"10101011\"\n"), "parse");
  EXPECT_EQ(code(head + "marker_1: \"101010111\"\n"), "parse");
  EXPECT_EQ(code("%YAML:1.0\nnmarkers: 1000000000\nmarkersize: 6\n"), "parse");
  EXPECT_EQ(code("words"), "parse");
  EXPECT_EQ(code(""), "parse");
}

TEST(TagDetector, TakesEveryKindOfImageAndRefusesTheRest) {
  const TagPattern pattern = *MakeTagPattern("aruco_original", 26);
  const TagDetectorPtr detector = *MakeTagDetector("aruco(dictionary=original)");
  const cv::Mat grey = Print(pattern);
  const auto count = [&detector](const cv::Mat& image) {
    const Expected<Detections> found = detector->Detect(image);
    return found ? static_cast<int>(found->tags.size()) : -1;
  };
  cv::Mat image;
  EXPECT_EQ(count(grey), 1);
  cv::cvtColor(grey, image, cv::COLOR_GRAY2BGR);
  EXPECT_EQ(count(image), 1);
  cv::cvtColor(grey, image, cv::COLOR_GRAY2BGRA);
  EXPECT_EQ(count(image), 1);
  grey.convertTo(image, CV_16U, 257.0);
  EXPECT_EQ(count(image), 1) << "16 bits";
  grey.convertTo(image, CV_16U, 16.0);
  EXPECT_EQ(count(image), 1) << "12 bits in 16";
  EXPECT_EQ(count(cv::Mat(300, 400, CV_8U, cv::Scalar(90))), 0) << "nothing there";
  grey.convertTo(image, CV_32F);
  EXPECT_EQ(count(image), -1);
  EXPECT_EQ(count(cv::Mat(1, 1, CV_8U, cv::Scalar(0))), -1);
  EXPECT_EQ(count(cv::Mat()), -1);
}

TEST(TagDetector, OneDetectorServesManyThreads) {
  const TagPattern pattern = *MakeTagPattern("tag36h11", 5);
  const TagDetectorPtr detector = *MakeTagDetector("apriltag(family=tag36h11)");
  const cv::Mat image = Print(pattern);
  std::array<std::vector<TagDetection>, 4> found;
  {
    std::vector<std::jthread> threads;
    for (auto& tags : found) {
      threads.emplace_back([&] { tags = detector->Detect(image)->tags; });
    }
  }
  for (const auto& tags : found) {
    ASSERT_EQ(tags.size(), 1U);
    EXPECT_EQ(tags[0].corners_px, found[0][0].corners_px);
  }
}

// The board described at CheckerDetection, and the same rotated by quarter turns.
TEST(Checkerboard, OrderFollowsTheBlackOuterSquare) {
  constexpr int kSquare_px = 30;
  cv::Mat board(7 * kSquare_px, 8 * kSquare_px, CV_8U, cv::Scalar(230));
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 6; ++column) {
      if ((row + column) % 2 == 1) continue;
      cv::rectangle(
          board,
          cv::Rect((column + 1) * kSquare_px, (row + 1) * kSquare_px, kSquare_px, kSquare_px), 25,
          cv::FILLED);
    }
  }
  const TagDetectorPtr detector = *MakeTagDetector("checkerboard(columns=5,rows=4)");
  for (int quarters = 0; quarters < 4; ++quarters) {
    const Expected<Detections> found = detector->Detect(board);
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->checkers.size(), 1U) << quarters;
    const CheckerDetection& checker = found->checkers[0];
    EXPECT_TRUE(checker.is_turn_known);
    // Corner (0, 0) of the upright board is at pixel (59.5, 59.5) and rotates with the board.
    Eigen::Vector2d first(2 * kSquare_px - 0.5, 2 * kSquare_px - 0.5);
    cv::Size size(8 * kSquare_px, 7 * kSquare_px);
    for (int i = 0; i < quarters; ++i) {
      first = Eigen::Vector2d(size.height - 1.0 - first.y(), first.x());
      std::swap(size.width, size.height);
    }
    EXPECT_LT((checker.corners_px[0] - first).norm(), 0.05) << quarters;
    cv::rotate(board, board, cv::ROTATE_90_CLOCKWISE);
  }
}

}  // namespace
}  // namespace sextant
