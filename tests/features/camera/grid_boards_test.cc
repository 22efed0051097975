// SPDX-License-Identifier: Apache-2.0
// AprilGrids and ChArUco boards in photos, real and rendered.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <opencv2/calib3d.hpp>
#include <set>
#include <string>
#include <vector>

#include "features/camera/find_boards.h"
#include "features/camera/find_families.h"
#include "features/camera/grey_image.h"
#include "io/boards/board_file.h"
#include "io/boards/board_templates.h"
#include "io/cameras/camera_file.h"
#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"
#include "support/pictures.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

struct GridPhoto {
  const char* file;
  std::size_t tags;
};

const GridPhoto kGridPhotos[] = {{"TUM_VI.png", 29},
                                 {"EuRoC.png", 26},
                                 {"right.png", 17},
                                 {"two_boards.png", 71},
                                 {"pjlab_april_board.jpg", 36}};

std::vector<TagDetection> TagsOfGrid(const std::filesystem::path& file, const std::string& spec) {
  const Expected<Detections> found = (*MakeTagDetector(spec))->Detect(ReadPicture(file.string()));
  EXPECT_TRUE(found);
  return found ? found->tags : std::vector<TagDetection>();
}

TEST(AprilGridPhotos, HaveTheirTagsAndNoneOfTheOrdinaryFamily) {
  SEXTANT_REAL_DATA(folder, "field/aprilgrid");
  for (const GridPhoto& photo : kGridPhotos) {
    const std::vector<TagDetection> tags =
        TagsOfGrid(folder / photo.file, "aruco(dictionary=tag36h11_border2)");
    std::set<int> ids;
    for (const TagDetection& tag : tags) ids.insert(tag.id);
    EXPECT_EQ(tags.size(), photo.tags) << photo.file;
    EXPECT_EQ(ids.size(), tags.size()) << photo.file;
    EXPECT_TRUE(TagsOfGrid(folder / photo.file, "apriltag(family=tag36h11)").empty()) << photo.file;
  }
}

// The layout and the tags' orientation: a homography from the grid to the image, which distorts
// little here, meets every corner.
TEST(AprilGridPhotos, AgreeWithKalibrsLayout) {
  SEXTANT_REAL_DATA(folder, "field/aprilgrid");
  const auto boards = ParseBoards(
      "target_type: 'aprilgrid'\ntagCols: 6\ntagRows: 6\ntagSize: 0.088\ntagSpacing: 0.3\n",
      "april.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  for (const char* file : {"pjlab_april_board.jpg", "EuRoC.png"}) {
    const BoardFinder finder = *BoardFinder::Make(*boards, std::nullopt);
    const Expected<SeenBoards> seen = finder.Find(ReadPicture((folder / file).string()));
    ASSERT_TRUE(seen);
    std::vector<cv::Point2d> in_board;
    std::vector<cv::Point2d> pixels;
    for (const BoardPoints& tag : seen->boards[0].printed) {
      for (std::size_t i = 0; i < 4; ++i) {
        in_board.emplace_back(tag.in_board_m[i].x(), tag.in_board_m[i].y());
        pixels.emplace_back(tag.pixels[i].x(), tag.pixels[i].y());
      }
    }
    ASSERT_GE(pixels.size(), 4U * 20U) << file;
    const cv::Mat homography = cv::findHomography(in_board, pixels);
    std::vector<cv::Point2d> predicted;
    cv::perspectiveTransform(in_board, predicted, homography);
    double squares = 0.0;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      squares += cv::norm(predicted[i] - pixels[i]) * cv::norm(predicted[i] - pixels[i]);
    }
    // Only the lens distortion remains; tags turned by a half would be off by 50 px.
    EXPECT_LT(std::sqrt(squares / static_cast<double>(pixels.size())), 3.0) << file;
  }
}

TEST(AprilGridPhotos, OfTheOrdinaryFamilySuggestTheGrids) {
  SEXTANT_REAL_DATA(folder, "field/aprilgrid");
  const cv::Mat grey = *ToGrey(ReadPicture((folder / "pjlab_april_board.jpg").string()));
  const std::vector<int> wanted = {0, 1, 2, 3};
  const std::vector<FamilyMatch> families = OtherFamilies(FindFamilies(grey), "tag36h11", wanted);
  ASSERT_FALSE(families.empty());
  EXPECT_EQ(families.front().family, "aruco_tag36h11_border2");
}

Board TutorialCharuco() {
  const auto boards = ParseBoards(
      "id: 0\ntop_right_m: 0.22\nright_bottom_m: 0.3\n"
      "charuco: {columns: 5, rows: 7, square_m: 0.04, marker_m: 0.02, family: aruco_6x6_250}\n",
      "charuco.yaml");
  EXPECT_TRUE(boards) << boards.error().message;
  return boards->front();
}

TEST(Charuco, CornersOfRealPhotosAgreeWithOnePose) {
  SEXTANT_REAL_DATA(folder, "aruco_gold");
  const Camera camera = *ReadCamera(folder / "tutorial_camera_charuco.yml");
  const BoardFinder finder = *BoardFinder::Make({TutorialCharuco()}, camera);
  for (const char* file : {"choriginal.jpg", "img_00.jpg", "img_02.jpg", "img_03.jpg"}) {
    const Expected<SeenBoards> seen = finder.Find(ReadPicture((folder / file).string()));
    ASSERT_TRUE(seen) << seen.error().message;
    const SeenBoard& board = seen->boards[0];
    EXPECT_FALSE(board.is_checker_missing) << file;
    EXPECT_EQ(board.printed.back().pixels.size(), 24U) << file;
    ASSERT_TRUE(board.pose && *board.pose) << file;
    EXPECT_LT((*board.pose)->rms_px, 0.3) << file;
  }
}

TEST(Charuco, CoveredCornersAreOmittedInARealPhoto) {
  SEXTANT_REAL_DATA(folder, "aruco_gold");
  const Camera camera = *ReadCamera(folder / "tutorial_camera_charuco.yml");
  const BoardFinder finder = *BoardFinder::Make({TutorialCharuco()}, camera);
  const Expected<SeenBoards> seen =
      finder.Find(ReadPicture((folder / "chocclusion_original.jpg").string()));
  ASSERT_TRUE(seen) << seen.error().message;
  const SeenBoard& board = seen->boards[0];
  EXPECT_GE(board.printed.back().pixels.size(), 8U);
  EXPECT_LT(board.printed.back().pixels.size(), 24U);
  ASSERT_TRUE(board.pose && *board.pose);
  EXPECT_LT((*board.pose)->rms_px, 0.3);
}

// Both grids, rendered with a known pose.
TEST(GridBoards, RenderedAreFoundAtTheirPose) {
  for (const char* name : {"aprilgrid", "charuco"}) {
    Scene scene;
    scene.cameras.push_back({.name = "cam", .model = "zed_left"});
    const Eigen::Quaterniond turn(
        Eigen::AngleAxisd(0.3, Eigen::Vector3d(0.5, 1.0, 0.2).normalized()));
    const Rigid3d pose{turn, {0.05, -0.02, 1.2}};
    scene.boards.push_back({.board = *FindBoardTemplate(name), .world_from_board = pose});
    const Expected<cv::Mat> image =
        RenderImage(scene, 0, {.seed = 1, .blur_sigma_px = 0.7, .noise_sigma_grey = 2.0});
    ASSERT_TRUE(image) << image.error().message;
    const BoardFinder finder =
        *BoardFinder::Make({scene.boards[0].board}, *FindCameraModel("zed_left"));
    const Expected<SeenBoards> seen = finder.Find(*image);
    ASSERT_TRUE(seen);
    const SeenBoard& board = seen->boards[0];
    EXPECT_TRUE(board.missing_tags.empty()) << name << " " << board.missing_tags.size();
    EXPECT_FALSE(board.is_checker_missing) << name;
    ASSERT_TRUE(board.pose && *board.pose) << name;
    const PoseDistance off = DistanceBetween((*board.pose)->cam_from_board, pose);
    EXPECT_LT(off.translation_m, 0.002) << name;
    EXPECT_LT(off.rotation_rad, 0.003) << name;
    if (std::string(name) == "charuco") {
      EXPECT_EQ(board.printed.back().pixels.size(), 24U);
    }
  }
}

}  // namespace
}  // namespace sextant::test
