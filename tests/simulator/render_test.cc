// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "simulator/scene/camera_model.h"
#include "support/one_board_scene.h"

namespace sextant::test {
namespace {

constexpr Camera kCamera{.width_px = 160,
                         .height_px = 120,
                         .fx_px = 150.0,
                         .fy_px = 150.0,
                         .cx_px = 79.5,
                         .cy_px = 59.5};

Board TagBoard() {
  return {.id = 7,
          .top_right_m = 0.5,
          .right_bottom_m = 0.4,
          .tags = {{.family = "tag36h11", .id = 3, .edge_m = 0.2}}};
}

Rigid3d At(double x, double y, double z) { return {.translation = {x, y, z}}; }

bool SameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && cv::countNonZero(a != b) == 0;
}

int LevelAt(const cv::Mat& image, int x, int y) { return image.at<std::uint8_t>(y, x); }

// A solid board, a hollow one in front of a wall, a floor, a box and a cylinder.
sextant::Scene FullScene() {
  sextant::Scene scene = OneBoardScene(kCamera, TagBoard(), At(-0.2, 0.0, 1.5));
  scene.boards.push_back(scene.boards.front());
  scene.boards[1].board = {.id = 8,
                           .top_right_m = 0.6,
                           .right_bottom_m = 0.6,
                           .hole = BoardHole{.width_m = 0.3, .height_m = 0.2}};
  scene.boards[1].world_from_board = At(0.5, -0.1, 2.0);
  scene.boards[1].swing = Swing{.amplitude_rad = 0.3};
  scene.walls = {{.name = "back", .world_from_wall = At(0, 0, 3), .width_m = 8, .height_m = 8}};
  scene.boxes = {{.name = "box", .world_from_box = At(0.1, 0.6, 2.0), .size_m = {0.3, 0.3, 0.3}}};
  scene.cylinders = {
      {.name = "pole", .base_in_world = {-0.9, -0.3, 1.9}, .radius_m = 0.2, .height_m = 0.6}};
  return scene;
}

TEST(RenderImage, GivesTheSameBytesOnOneAndTwoThreads) {
  ImageOptions options = UsualImageOptions(5, 0.2);
  cv::Mat one;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    one = *RenderImage(FullScene(), 0, options);
  }
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
  EXPECT_TRUE(SameBytes(one, *RenderImage(FullScene(), 0, options)));
  options.seed = 6;
  EXPECT_FALSE(SameBytes(one, *RenderImage(FullScene(), 0, options)));
}

TEST(RenderImage, MovesASwingingBoard) {
  const auto at = [](double time_s) { return *RenderImage(FullScene(), 0, {.time_s = time_s}); };
  EXPECT_FALSE(SameBytes(at(0.0), at(0.25)));
  EXPECT_TRUE(SameBytes(at(0.0), at(0.5)));
}

TEST(RenderImage, UsesTheTrueNotTheAssumedIntrinsics) {
  sextant::Scene scene = FullScene();
  const cv::Mat true_image = *RenderImage(scene, 0, {});
  scene.cameras[0].assumed_intrinsics = kCamera;
  scene.cameras[0].assumed_intrinsics->fx_px *= 1.02;
  EXPECT_TRUE(SameBytes(*RenderImage(scene, 0, {}), true_image));
  EXPECT_EQ(PublishedCamera(scene.cameras[0])->fx_px, 1.02 * kCamera.fx_px);
  EXPECT_EQ(RenderingCamera(scene.cameras[0])->fx_px, kCamera.fx_px);
}

TEST(RenderImage, BoardsOccludeExceptThroughHoles) {
  sextant::Scene scene = OneBoardScene(kCamera,
                                       {.top_right_m = 0.6,
                                        .right_bottom_m = 0.6,
                                        .hole = BoardHole{.width_m = 0.2, .height_m = 0.2}},
                                       At(0.0, 0.0, 1.0));
  EXPECT_EQ(LevelAt(*RenderImage(scene, 0, EvenLight()), 79, 59), 90);
  scene.boards.push_back(scene.boards.front());
  scene.boards[1].board = {.top_right_m = 0.4, .right_bottom_m = 0.4};
  scene.boards[1].white.albedo = 150.0 / 255.0;
  scene.boards[1].world_from_board = At(0.0, 0.0, 1.2);
  const cv::Mat behind = *RenderImage(scene, 0, EvenLight());
  EXPECT_EQ(LevelAt(behind, 79, 59), 150);
  EXPECT_EQ(LevelAt(behind, 79, 59 + 22), 250) << "15 px is the hole's half side, 25 the other's";
  scene.boards[1].world_from_board = At(0.0, 0.0, 0.9);
  EXPECT_EQ(LevelAt(*RenderImage(scene, 0, EvenLight()), 79, 59 + 22), 150);
}

TEST(RenderImage, RoundHolesAreRound) {
  sextant::Scene scene = OneBoardScene(
      kCamera, {.top_right_m = 0.6, .right_bottom_m = 0.6, .round_holes = {{.radius_m = 0.1}}},
      At(0.0, 0.0, 1.0));
  const cv::Mat image = *RenderImage(scene, 0, EvenLight());
  const int background = LevelAt(image, 79, 59);
  EXPECT_NE(background, LevelAt(image, 79, 59 + 22));
  EXPECT_EQ(LevelAt(image, 79, 59 + 12), background) << "15 px is the hole's radius";
  EXPECT_EQ(LevelAt(image, 79 + 12, 59 + 12), LevelAt(image, 79, 59 + 22)) << "17 px off";
}

TEST(RenderImage, ShowsAPlainBack) {
  const Eigen::Quaterniond about(Eigen::AngleAxisd(std::acos(-1.0), Eigen::Vector3d::UnitY()));
  const sextant::Scene scene = OneBoardScene(kCamera, TagBoard(), {about, {0.0, 0.0, 1.0}});
  const cv::Mat image = *RenderImage(scene, 0, EvenLight());
  EXPECT_EQ(cv::countNonZero(image == 20), 0);
  EXPECT_EQ(cv::countNonZero(image == 250), 74 * 60)
      << "75 x 60 px, whose left and right end halve a column each";
}

TEST(RenderImage, ShowsTheSquaresOfACheckerboard) {
  const Board board{.top_right_m = 0.5,
                    .right_bottom_m = 0.4,
                    .checker = BoardChecker{.inner_columns = 4, .inner_rows = 3, .square_m = 0.08}};
  const cv::Mat image = *RenderImage(OneBoardScene(kCamera, board, At(0, 0, 1.0)), 0, EvenLight());
  // 5 x 4 squares of 12 px, ten of each colour. Their edges coincide with pixel borders, where
  // rounding may put a ray on either side.
  EXPECT_EQ(cv::countNonZero(image < 30), 10 * 12 * 12);
  EXPECT_EQ(LevelAt(image, 79 - 30 + 5, 59 - 24 + 5), 20) << "top-left";
  EXPECT_EQ(LevelAt(image, 79 - 30 + 17, 59 - 24 + 5), 250);
}

// The total light is preserved however small the print: mean over an image of a distant
// checkerboard.
TEST(RenderImage, KeepsTheMeanOfDetailsSmallerThanAPixel) {
  const Board board{
      .top_right_m = 2.0,
      .right_bottom_m = 2.0,
      .checker = BoardChecker{.inner_columns = 99, .inner_rows = 99, .square_m = 0.02}};
  const Rigid3d pose{Eigen::Quaterniond(Eigen::AngleAxisd(0.3, Eigen::Vector3d::UnitZ())),
                     {0.0, 0.0, 5.0}};
  const cv::Mat image = *RenderImage(OneBoardScene(kCamera, board, pose), 0, EvenLight());
  const cv::Mat middle = image(cv::Rect(65, 45, 30, 30));
  EXPECT_NEAR(cv::mean(middle)[0], 135.0, 1.0);
}

// A pole of 0.3 px at any position between the pixel corners: its contribution to the light of each
// row.
TEST(RenderImage, ShowsObjectsNarrowerThanAPixel) {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  for (const double shift_px : {0.0, 0.25, 0.5, 0.8}) {
    sextant::Scene scene;
    scene.cameras = {{.intrinsics = kCamera, .world_from_cam = {Eigen::Quaterniond(axes), {}}}};
    scene.cameras[0].world_from_cam.translation.setZero();
    scene.cylinders = {{.name = "pole",
                        .base_in_world = {1.0, -shift_px / 150.0, -1.0},
                        .radius_m = 0.001,
                        .height_m = 2.0,
                        .surface = {.albedo = 1.0}}};
    scene.background_albedo = 90.0 / 255.0;
    const cv::Mat image = *RenderImage(scene, 0, EvenLight());
    for (const int y : {0, 30, 59, 119}) {
      // The step is 165 grey levels; two pixels are rounded.
      EXPECT_NEAR((cv::sum(image.row(y))[0] - 90.0 * image.cols) / 165.0, 0.3, 0.01)
          << "row " << y << ", shift " << shift_px;
    }
  }
}

TEST(RenderImage, VignettingDarkensTheFarthestCornerAsSpecified) {
  sextant::Scene scene = OneBoardScene(kCamera, TagBoard(), At(0, 0, -1));
  scene.background_albedo = 200.0 / 255.0;
  const cv::Mat image = *RenderImage(scene, 0, {.vignetting = 0.5});
  EXPECT_NEAR(LevelAt(image, 0, 0), 101.0, 1.0);
  EXPECT_EQ(LevelAt(image, 79, 59), 200);
}

TEST(RenderImage, CompressesAsJpegOnRequest) {
  const cv::Mat plain = *RenderImage(FullScene(), 0, {});
  const cv::Mat coded = *RenderImage(FullScene(), 0, {.jpeg_quality = 80});
  EXPECT_FALSE(SameBytes(plain, coded));
  EXPECT_LT(cv::norm(plain, coded, cv::NORM_L1) / static_cast<double>(plain.total()), 4.0);
}

// The disparity is that of the baseline.
TEST(StereoPartner, HasTheDisparityOfItsBaseline) {
  sextant::Scene scene = OneBoardScene(kCamera, TagBoard(), At(0, 0, 1.5));
  scene.cameras.push_back(StereoPartner(scene.cameras[0], 0.12, "right"));
  const auto center = [&](int camera) {
    const cv::Mat image = *RenderImage(scene, camera, EvenLight());
    cv::Mat light;
    image.convertTo(light, CV_64F, 1.0, -90.0);
    double sum = 0.0;
    double moment = 0.0;
    for (int y = 0; y < light.rows; ++y) {
      for (int x = 0; x < light.cols; ++x) {
        sum += light.at<double>(y, x);
        moment += x * light.at<double>(y, x);
      }
    }
    return moment / sum;
  };
  EXPECT_NEAR(center(0) - center(1), kCamera.fx_px * 0.12 / 1.5, 0.01);
}

struct BadRender {
  const char* name;
  ErrorCode code;
  const char* message;
  void (*spoil)(sextant::Scene&, int& camera, ImageOptions&);
};

class BadRenderTest : public testing::TestWithParam<BadRender> {};

TEST_P(BadRenderTest, IsRejectedByName) {
  sextant::Scene scene = FullScene();
  int camera = 0;
  ImageOptions options;
  GetParam().spoil(scene, camera, options);
  const Expected<cv::Mat> image = RenderImage(scene, camera, options);
  ASSERT_FALSE(image);
  EXPECT_EQ(ToString(image.error().code), ToString(GetParam().code)) << image.error().message;
  EXPECT_THAT(image.error().message, testing::HasSubstr(GetParam().message));
}

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadRenderTest,
    testing::Values(
        BadRender{"camera", ErrorCode::kInvalidInput, "there is no 1",
                  [](auto&, int& camera, auto&) { camera = 1; }},
        BadRender{"negative_camera", ErrorCode::kInvalidInput, "there is no -1",
                  [](auto&, int& camera, auto&) { camera = -1; }},
        BadRender{"model", ErrorCode::kUnknownName, "zed_left",
                  [](auto& scene, int&, auto&) { scene.cameras[0].model = "zed_lefft"; }},
        BadRender{"size", ErrorCode::kInvalidInput, "0 x 120",
                  [](auto& scene, int&, auto&) { scene.cameras[0].intrinsics.width_px = 0; }},
        BadRender{"huge", ErrorCode::kInvalidInput, "100000 x 100000",
                  [](auto& scene, int&, auto&) {
                    scene.cameras[0].intrinsics.width_px = 100000;
                    scene.cameras[0].intrinsics.height_px = 100000;
                    scene.cameras[0].intrinsics.fx_px = 50000.0;
                  }},
        BadRender{"focal", ErrorCode::kInvalidInput, "focal",
                  [](auto& scene, int&, auto&) { scene.cameras[0].intrinsics.fx_px = 0.0; }},
        BadRender{"family", ErrorCode::kUnknownName, "tag36h11",
                  [](auto& scene, int&, auto&) { scene.boards[0].board.tags[0].family = "tag36"; }},
        BadRender{"id", ErrorCode::kInvalidInput, "board 7",
                  [](auto& scene, int&, auto&) { scene.boards[0].board.tags[0].id = 587; }},
        BadRender{"board", ErrorCode::kInvalidInput, "board 7",
                  [](auto& scene, int&, auto&) { scene.boards[0].board.top_right_m = -0.5; }},
        BadRender{"pose", ErrorCode::kNonFinite, "board 7",
                  [](auto& scene, int&, auto&) {
                    scene.boards[0].world_from_board.translation.x() = kNaN;
                  }},
        BadRender{"wall", ErrorCode::kInvalidInput, "wall back",
                  [](auto& scene, int&, auto&) { scene.walls[0].width_m = 0.0; }},
        BadRender{"tiles", ErrorCode::kInvalidInput, "wall back",
                  [](auto& scene, int&, auto&) { scene.walls[0].tile_m = 1e-12; }},
        BadRender{"many_tiles", ErrorCode::kInvalidInput, "at most 30000 along a side",
                  [](auto& scene, int&, auto&) {
                    scene.walls[0].width_m = 1e7;
                    scene.walls[0].tile_m = 1e-3;
                  }},
        BadRender{"albedo", ErrorCode::kInvalidInput, "board 7",
                  [](auto& scene, int&, auto&) { scene.boards[0].black.albedo = kNaN; }},
        BadRender{"background", ErrorCode::kInvalidInput, "background",
                  [](auto& scene, int&, auto&) { scene.background_albedo = 1.5; }},
        BadRender{"box", ErrorCode::kInvalidInput, "box box",
                  [](auto& scene, int&, auto&) { scene.boxes[0].size_m.y() = -1.0; }},
        BadRender{"cylinder", ErrorCode::kInvalidInput, "cylinder pole",
                  [](auto& scene, int&, auto&) { scene.cylinders[0].radius_m = 0.0; }},
        BadRender{"exposure", ErrorCode::kInvalidInput, "exposure",
                  [](auto&, int&, auto& options) { options.exposure = 0.0; }},
        BadRender{"blur", ErrorCode::kInvalidInput, "blur_sigma_px",
                  [](auto&, int&, auto& options) { options.blur_sigma_px = kNaN; }},
        BadRender{"jpeg", ErrorCode::kInvalidInput, "jpeg_quality",
                  [](auto&, int&, auto& options) { options.jpeg_quality = 0; }}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace sextant::test
