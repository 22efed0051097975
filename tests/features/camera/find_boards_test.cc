// SPDX-License-Identifier: Apache-2.0
#include "features/camera/find_boards.h"

#include <gmock/gmock.h>

#include <numbers>
#include <opencv2/imgproc.hpp>
#include <string>

#include "base/random.h"
#include "features/camera/explain_missing.h"
#include "geometry/board_check.h"
#include "geometry/so3.h"
#include "geometry/symmetric.h"
#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

using testing::HasSubstr;

// A hollow board with a tag at each corner, and a solid one with a checkerboard.
Board HollowBoard() {
  Board board{.id = 0, .top_right_m = 0.7, .right_bottom_m = 0.7};
  board.hole = BoardHole{.width_m = 0.35, .height_m = 0.35};
  int id = 3;
  for (const auto& [x, y] :
       {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    board.tags.push_back({.family = "tag36h11",
                          .id = id++,
                          .edge_m = 0.11,
                          .center_in_board_m = {0.26 * x, 0.26 * y},
                          .rotation_rad = 0.5 * std::numbers::pi * id});
  }
  return board;
}

Board CheckerBoard() {
  Board board{.id = 1, .top_right_m = 0.6, .right_bottom_m = 0.5};
  board.checker = BoardChecker{.inner_columns = 6, .inner_rows = 5, .square_m = 0.06};
  return board;
}

Rigid3d HeldByACorner(const Eigen::Vector3d& place, double lean_rad) {
  Rigid3d pose;
  pose.rotation = ExpSo3(Eigen::Vector3d(0.3 * lean_rad, lean_rad, 0.0)) *
                  ExpSo3(Eigen::Vector3d(0.0, 0.0, 0.25 * std::numbers::pi));
  pose.translation = place;
  return pose;
}

struct Photo {
  cv::Mat image;
  Camera camera;
  std::vector<Rigid3d> cam_from_board;
};

// The world frame is the camera's.
Photo Photograph(const std::vector<Board>& boards, const std::vector<Rigid3d>& poses,
                 std::uint64_t seed) {
  Scene scene;
  scene.cameras.push_back({.name = "cam", .model = "zed_left"});
  for (std::size_t i = 0; i < boards.size(); ++i) {
    scene.boards.push_back({.board = boards[i], .world_from_board = poses[i]});
  }
  const Expected<cv::Mat> image =
      RenderImage(scene, 0, {.seed = seed, .blur_sigma_px = 0.7, .noise_sigma_grey = 3.0});
  EXPECT_TRUE(image) << image.error().message;
  return {.image = *image, .camera = *FindCameraModel("zed_left"), .cam_from_board = poses};
}

// All corners of both boards, their covariance, and the correlation between the corners.
TEST(FindBoards, CornersInTheCameraFrameAreWithinTheirCovariance) {
  const std::vector<Board> boards = {HollowBoard(), CheckerBoard()};
  constexpr int kViews = 8;
  std::array<double, 2> nees{};
  int checkers_missed = 0;
  for (int view = 0; view < kViews; ++view) {
    Random random(DeriveSeed(1, "find_boards", 0, static_cast<std::uint64_t>(view)));
    const double lean = random.Uniform(-0.6, 0.6);
    const double depth = random.Uniform(1.6, 2.4);
    const Photo photo = Photograph(
        boards, {HeldByACorner({-0.55, 0.0, depth}, lean), HeldByACorner({0.5, 0.1, depth}, -lean)},
        static_cast<std::uint64_t>(view));
    const BoardFinder finder = *BoardFinder::Make(boards, photo.camera);
    const Expected<SeenBoards> seen = finder.Find(photo.image);
    ASSERT_TRUE(seen) << seen.error().message;
    EXPECT_TRUE(seen->other_tags.empty());
    ASSERT_EQ(seen->boards[0].tags.size(), 4U);
    for (const SeenTag& tag : seen->boards[0].tags) EXPECT_TRUE(tag.refined);
    for (std::size_t b = 0; b < 2; ++b) {
      const SeenBoard& board = seen->boards[b];
      if (b == 1 && !board.checker) {
        EXPECT_TRUE(board.is_checker_missing);
        EXPECT_FALSE(board.pose);
        ++checkers_missed;
        continue;
      }
      ASSERT_TRUE(board.pose && *board.pose) << b;
      EXPECT_FALSE((*board.pose)->ambiguous_with);
      const Vector6d error = PoseDifference(photo.cam_from_board[b], (*board.pose)->cam_from_board);
      nees[b] += SquaredMahalanobis(error, (*board.pose)->covariance) / 6.0 / kViews;
      const std::vector<Eigen::Vector3d> corners = BoardCorners(boards[b]);
      ASSERT_EQ(board.corners.points.size(), b == 0 ? 8U : 4U);
      for (std::size_t k = 0; k < corners.size(); ++k) {
        const Eigen::Vector3d truth = photo.cam_from_board[b] * corners[k];
        const Eigen::Vector3d off = board.corners.points[k] - truth;
        EXPECT_LT(off.norm(), 0.004) << "board " << b << " corner " << k;
        const Eigen::Matrix3d covariance = board.corners.CovarianceOf(k);
        EXPECT_LT(SquaredMahalanobis(off, covariance), 40.0) << b << " " << k;
        // Depth is a camera's least certain coordinate.
        EXPECT_GT(covariance(2, 2), covariance(0, 0));
      }
      // The board is rigid: only 6 of the corners' 12 or 24 coordinates are independent.
      const Eigen::VectorXd variances = EigenOf<Eigen::Dynamic>(board.corners.covariance).values;
      EXPECT_EQ((variances.array() > 1e-9 * variances.maxCoeff()).count(), 6);
    }
  }
  EXPECT_LE(checkers_missed, 1);
  // 8 poses of 6 numbers: the mean of 48 squares has a standard error of sqrt(2 / 48) = 0.2. The
  // sigma of checkerboard corners is an upper bound, not an estimate.
  EXPECT_GT(nees[0], 0.5);
  EXPECT_LT(nees[0], 1.6);
  EXPECT_LT(nees[1], 1.6);
}

// From afar, a single tag does not determine the tilt of the board; a second tag on it does.
TEST(FindBoards, AmbiguityIsReportedAndResolvedByOtherTags) {
  Board one{.id = 0, .top_right_m = 0.9, .right_bottom_m = 0.3};
  one.tags = {{.family = "tag36h11", .id = 1, .edge_m = 0.1, .center_in_board_m = {-0.35, 0.0}}};
  Board two = one;
  two.tags.push_back(
      {.family = "tag36h11", .id = 2, .edge_m = 0.1, .center_in_board_m = {0.35, 0.0}});
  Rigid3d pose;
  pose.rotation = ExpSo3(Eigen::Vector3d(0.01, 0.05, 0.0));
  pose.translation = {0.0, 0.0, 4.0};
  const Photo photo = Photograph({two}, {pose}, 5);
  const auto find = [&photo](const Board& board) {
    return *BoardFinder::Make({board}, photo.camera)->Find(photo.image);
  };
  const SeenBoards alone = find(one);
  ASSERT_TRUE(alone.boards[0].pose && *alone.boards[0].pose);
  EXPECT_TRUE((*alone.boards[0].pose)->ambiguous_with);
  EXPECT_EQ(alone.other_tags.size(), 1U);
  const SeenBoards both = find(two);
  ASSERT_TRUE(both.boards[0].pose && *both.boards[0].pose);
  EXPECT_FALSE((*both.boards[0].pose)->ambiguous_with);
  EXPECT_LT(DistanceBetween((*both.boards[0].pose)->cam_from_board, pose).rotation_rad, 0.02);
}

// Among tags of decreasing size, every one that is found in the full image is found.
TEST(FindBoards, TagsMissedInTheDecimatedImageAreFoundInTheFullOne) {
  Rigid3d pose;
  pose.translation = {0.0, 0.0, 2.0};
  int hidden = 0;
  for (const double side_px : {30.0, 26.0, 22.0, 18.0, 16.0, 14.0, 12.0}) {
    Board board{.id = 0, .top_right_m = 0.6, .right_bottom_m = 0.4};
    board.tags = {{.family = "tag36h11", .id = 1, .edge_m = 0.2, .center_in_board_m = {-0.15, 0.0}},
                  {.family = "tag36h11",
                   .id = 2,
                   .edge_m = side_px / 350.0,
                   .center_in_board_m = {0.15, 0.0}}};
    const Photo photo = Photograph({board}, {pose}, 6);
    const auto sees_all = [&](const std::string& detector) {
      const SeenBoards seen =
          *BoardFinder::Make({board}, photo.camera, detector)->Find(photo.image);
      return seen.boards[0].missing_tags.empty();
    };
    for (const std::string library : {"apriltag", "aruco"}) {
      if (!sees_all(library + "(decimate=1)")) continue;
      EXPECT_TRUE(sees_all(library)) << library << " " << side_px;
      if (!sees_all(library + "(decimate=2)")) ++hidden;
    }
  }
  EXPECT_GT(hidden, 0);
}

// OpenCV detects AprilTag's families too, but begins at another corner.
TEST(FindBoards, EitherLibraryGivesTheSamePose) {
  const Board board = HollowBoard();
  const Rigid3d pose = HeldByACorner({0.1, -0.05, 1.6}, 0.3);
  const Photo photo = Photograph({board}, {pose}, 3);
  for (const char* detector : {"", "apriltag(decimate=2)", "aruco", "aruco(refine=subpix)"}) {
    const Expected<BoardFinder> finder = BoardFinder::Make({board}, photo.camera, detector);
    ASSERT_TRUE(finder) << finder.error().message;
    const Expected<SeenBoards> seen = finder->Find(photo.image);
    ASSERT_TRUE(seen) << seen.error().message;
    ASSERT_TRUE(seen->boards[0].pose && *seen->boards[0].pose) << detector;
    const PoseDistance distance = DistanceBetween((*seen->boards[0].pose)->cam_from_board, pose);
    EXPECT_LT(distance.translation_m, 0.002) << detector;
    EXPECT_LT(distance.rotation_rad, 0.01) << detector;
  }
}

TEST(FindBoards, RefusesBoardsThatCannotBeDetected) {
  const auto message = [](std::vector<Board> boards, const std::string& detector = "") {
    const Expected<BoardFinder> made = BoardFinder::Make(std::move(boards), std::nullopt, detector);
    return made ? std::string() : made.error().message;
  };
  Board bare{.id = 7, .top_right_m = 0.5, .right_bottom_m = 0.5};
  EXPECT_THAT(message({bare}), HasSubstr("board 7 has neither"));
  Board other = HollowBoard();
  other.id = 9;
  EXPECT_THAT(message({HollowBoard(), other}), HasSubstr("on two boards"));
  Board aruco = bare;
  aruco.tags = {{.family = "aruco_original", .id = 26, .edge_m = 0.2}};
  EXPECT_THAT(message({aruco}, "apriltag"), HasSubstr("does not detect tags of aruco_original"));
  aruco.tags[0].family = "aruco_orignal";
  EXPECT_THAT(message({aruco}), HasSubstr("did you mean 'aruco_original'?"));
  Camera camera = *FindCameraModel("zed_left");
  const BoardFinder finder = *BoardFinder::Make({HollowBoard()}, camera);
  const Expected<SeenBoards> seen = finder.Find(cv::Mat(480, 640, CV_8U, cv::Scalar(0)));
  ASSERT_FALSE(seen);
  EXPECT_THAT(seen.error().message, HasSubstr("640 x 480"));
}

MissingTag Explain(const cv::Mat& image, const BoardTag& tag, const Camera* camera,
                   const BoardPose* pose) {
  TagTrials trials(image);
  return ExplainMissing(trials, tag, camera, pose);
}

TEST(FindBoards, RefusesAFocalLengthInMillimetres) {
  const Camera camera{.fx_px = 4.2, .fy_px = 4.2, .cx_px = 3.2, .cy_px = 2.4};
  const cv::Mat image(480, 640, CV_8U, cv::Scalar(128));
  const auto seen = BoardFinder::Make({CheckerBoard()}, camera)->Find(image);
  ASSERT_FALSE(seen);
  EXPECT_THAT(seen.error().message, HasSubstr("4.2 px in an image 640 px wide"));
}

TEST(ExplainMissing, NamesTheCause) {
  const Board board = HollowBoard();
  const Rigid3d pose = HeldByACorner({0.0, 0.0, 1.5}, 0.2);
  const Photo photo = Photograph({board}, {pose}, 4);
  const BoardTag& tag = board.tags[0];
  const auto cause = [](const cv::Mat& image, const BoardTag& missing) {
    return std::string(ToString(Explain(image, missing, nullptr, nullptr).cause));
  };
  cv::Mat changed;
  cv::flip(photo.image, changed, 1);
  EXPECT_EQ(cause(changed, tag), "mirrored");
  cv::GaussianBlur(photo.image, changed, {}, 5.0);
  EXPECT_THAT(cause(changed, tag), testing::AnyOf("blurred", "not_there"));
  BoardTag wrong = tag;
  wrong.family = "aruco_5x5_250";
  const MissingTag other = Explain(photo.image, wrong, nullptr, nullptr);
  EXPECT_EQ(other.cause, MissingCause::kOtherFamily);
  EXPECT_THAT(other.text, HasSubstr("36h11: 3, 4, 5, 6"));
  EXPECT_EQ(cause(cv::Mat(200, 300, CV_8U, cv::Scalar(90)), tag), "not_there");

  // The board's pose predicts the position of the tag.
  const BoardPose known{.cam_from_board = pose};
  changed = cv::Mat(photo.image.size(), CV_8U, cv::Scalar(128));
  EXPECT_EQ(Explain(changed, tag, &photo.camera, &known).cause, MissingCause::kCovered);
  const MissingTag seen = Explain(photo.image, tag, &photo.camera, &known);
  EXPECT_EQ(seen.cause, MissingCause::kOverlooked);
  EXPECT_THAT(seen.text, HasSubstr("36 of its 36 cells are read correctly"));
  BoardPose far = known;
  far.cam_from_board.translation.z() = 30.0;
  EXPECT_EQ(Explain(photo.image, tag, &photo.camera, &far).cause, MissingCause::kTooSmall);
  far = known;
  far.cam_from_board.translation.x() = 2.0;
  EXPECT_EQ(Explain(photo.image, tag, &photo.camera, &far).cause, MissingCause::kOutsideImage);
}

}  // namespace
}  // namespace sextant
