// SPDX-License-Identifier: Apache-2.0
#include "report/collect/collect_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <opencv2/core.hpp>
#include <string>

#include "base/units.h"
#include "report/collect/file_hash.h"
#include "report/collect/no_pose.h"
#include "report/collect/pose_in_words.h"
#include "report/collect/utc_text.h"
#include "report/collect/view_media.h"
#include "report/page/page_html.h"
#include "support/calibration_result.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

// Looks along the LiDAR's x from its origin, with a board 2 m away in each view.
CalibrationResult ResultWith(int views) {
  CalibrationResult result = test::FullCalibrationResult();
  result.camera = Camera{.width_px = 480,
                         .height_px = 300,
                         .fx_px = 250.0,
                         .fy_px = 250.0,
                         .cx_px = 239.5,
                         .cy_px = 149.5};
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  result.cam_from_lidar = {Eigen::Quaterniond(axes), Eigen::Vector3d::Zero()};
  result.boards = {Board{.id = 26, .top_right_m = 0.6, .right_bottom_m = 0.6}};
  const Rigid3d cam_from_board{Eigen::Quaterniond::Identity(), {0.0, 0.0, 2.0}};
  ResultView view{.name = "view"};
  view.rmse_m = 0.01;
  view.boards = {{.board = 26,
                  .cam_from_board = cam_from_board,
                  .lidar_from_board = result.cam_from_lidar.Inverse() * cam_from_board,
                  .residuals_m = {0.01, 0.01, 0.01, 0.01},
                  .residuals_px = {0.5, 0.5, 0.5, 0.5}}};
  result.views.assign(static_cast<std::size_t>(views), view);
  for (int i = 0; i < views; ++i) result.views[static_cast<std::size_t>(i)].view = i;
  return result;
}

// A photo that hardly compresses, and a scan of a wall 3 m away behind the board.
Frame NoisyFrame() {
  Frame frame;
  frame.image = cv::Mat(300, 480, CV_8UC3);
  cv::RNG noise(1);
  noise.fill(frame.image, cv::RNG::UNIFORM, 0, 256);
  for (int i = 0; i < 100; ++i) {
    for (int k = 0; k < 60; ++k) {
      const double y = -2.0 + 0.04 * i;
      const double z = -1.0 + 0.033 * k;
      const bool is_board = std::abs(y) < 0.3 && std::abs(z) < 0.3;
      frame.cloud.points.emplace_back(is_board ? 2.0 : 3.0, y, z);
      frame.cloud.intensity.push_back(static_cast<float>(k));
    }
  }
  return frame;
}

FrameSource AlwaysThe(const Frame& frame) {
  return [&frame](const std::vector<ResultView>& views, const FrameVisitor& visit) {
    for (std::size_t i = 0; i < views.size(); ++i) visit(i, frame);
    return Expected<void>();
  };
}

TEST(CollectPage, AHundredViewsFitIntoThePage) {
  const Frame frame = NoisyFrame();
  const ReportPage page = CollectPage({.result = ResultWith(100), .frames = AlwaysThe(frame)});
  ASSERT_THAT(page.views, SizeIs(100));
  for (const PageView& view : page.views) {
    ASSERT_TRUE(view.photo && view.scan);
    EXPECT_GT(view.photo->jpeg.size(), 3000U);
    EXPECT_GT(view.scan->in_base.size(), 3000U);
    EXPECT_GT(view.photo->dots.size(), 1000U);
  }
  EXPECT_LT(FormatPage(page).size(), kMaxPageBytes);
}

TEST(CollectPage, TheBoardIsWhereBothSensorsSawIt) {
  const Frame frame = NoisyFrame();
  const ReportPage page = CollectPage({.result = ResultWith(1), .frames = AlwaysThe(frame)});
  const PageBoard& board = page.views.at(0).boards.at(0);
  ASSERT_THAT(board.by_camera, SizeIs(4));
  ASSERT_THAT(board.by_lidar, SizeIs(4));
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR((board.by_camera[i] - board.by_lidar[i]).norm(), 0.0, 1e-12);
  }
  EXPECT_NEAR((board.by_camera[0] - Eigen::Vector3d(2.0, 0.3, 0.3)).norm(), 0.0, 1e-12);
  EXPECT_NEAR((board.camera_in_px.at(0) - Eigen::Vector2d(202.0, 112.0)).norm(), 0.0, 1e-9);
  EXPECT_NEAR(page.coverage.at(0).share, 4.0 / 40.0, 1.0 / 40.0 + 1e-9);
}

TEST(CollectPage, ACameraWithoutItsSizeHasThatOfThePhoto) {
  const Frame frame = NoisyFrame();
  CalibrationResult result = ResultWith(1);
  const ReportPage stated = CollectPage({.result = result, .frames = AlwaysThe(frame)});
  result.camera->width_px = 0;
  result.camera->height_px = 0;
  const ReportPage page = CollectPage({.result = result, .frames = AlwaysThe(frame)});
  ASSERT_TRUE(page.views[0].photo);
  EXPECT_EQ(page.views[0].photo->width_px, 480);
  EXPECT_FALSE(page.views[0].photo->dots.empty());
  EXPECT_EQ(page.views[0].photo->dots.size(), stated.views[0].photo->dots.size());
}

TEST(CollectPage, AViewWithoutFilesSaysWhy) {
  CalibrationResult result = ResultWith(2);
  result.views[0].image_path = "absent.png";
  result.views[0].cloud_path = "absent.pcd";
  const ReportPage page =
      CollectPage({.result = result, .frames = FramesOfFiles(test::TestFolder())});
  EXPECT_THAT(page.views[0].no_photo, HasSubstr("absent.png"));
  EXPECT_THAT(page.views[1].no_photo, HasSubstr("names no files"));
  EXPECT_FALSE(page.views[0].photo);
  EXPECT_THAT(page.noise.note, HasSubstr("sextant calibrate --report"));
  EXPECT_THAT(page.comparison.rows, IsEmpty());
  EXPECT_THAT(page.inputs.files.rows, SizeIs(2));
  EXPECT_EQ(page.inputs.files.rows[0][2], "not a readable file");
}

TEST(CollectPage, HoldsWhatTheResultHolds) {
  const CalibrationResult result = test::FullCalibrationResult();
  const ReportPage page = CollectPage({.result = result, .written = "2026-01-02"});
  EXPECT_EQ(page.verdict.word, "USABLE WITH CARE");
  EXPECT_EQ(page.verdict.tone, PageTone::kCaution);
  EXPECT_THAT(page.views, SizeIs(result.views.size()));
  EXPECT_EQ(page.diagnostics, result.warnings);
  EXPECT_EQ(page.closing, result.closing);
  EXPECT_THAT(page.date, HasSubstr("Recorded 2017-05-03"));
  EXPECT_THAT(page.date, HasSubstr("report of 2026-01-02"));
  EXPECT_THAT(page.sigmas.rows, SizeIs(4));
  EXPECT_THAT(FormatPage(page), HasSubstr("</html>"));
}

// Nothing on the page may look as if a pose was known.
TEST(CollectPage, WithoutAPoseItShowsTheViewsAndWhyTheyWereLeftOut) {
  const CalibrationResult known = ResultWith(1);
  const Rigid3d& cam_from_board = *known.views[0].boards[0].cam_from_board;
  Calibration calibration;
  calibration.observed.camera = *known.camera;
  calibration.observed.boards = known.boards;
  Observation seen;
  seen.in_image.resize(1);
  seen.in_image[0].board = 0;
  seen.in_image[0].pose.cam_from_board = cam_from_board;
  seen.missing = {{.board = 0, .image = false, .why = "no plate of its size"}};
  calibration.observed.views = {
      {.name = "1", .seen = seen},
      {.name = "2", .seen = MakeError(ErrorCode::kIo, "2.png: not an image")}};
  Error error(ErrorCode::kMissingData, "no board was seen by both sensors");
  error.AddLine("view 1: not in the scan");
  calibration.result = tl::unexpected<Error>(error);
  const Frame frame = NoisyFrame();
  const ReportPage page = CollectPage({.result = ResultWithoutPose(calibration),
                                       .calibration = &calibration,
                                       .frames = AlwaysThe(frame)});
  EXPECT_EQ(page.verdict.word, "NOT USABLE");
  EXPECT_EQ(page.verdict.reason, "No board was seen by both sensors");
  EXPECT_THAT(page.diagnostics, testing::ElementsAre("view 1: not in the scan"));
  EXPECT_THAT(page.transforms, IsEmpty());
  ASSERT_THAT(page.views, SizeIs(2));
  EXPECT_EQ(page.views[0].reason, "scan: no plate of its size");
  EXPECT_EQ(page.views[1].reason, "2.png: not an image");
  ASSERT_THAT(page.views[0].boards, SizeIs(1));
  EXPECT_THAT(page.views[0].boards[0].camera_in_px, Not(IsEmpty()));
  EXPECT_THAT(page.views[0].boards[0].by_camera, IsEmpty());
  ASSERT_TRUE(page.views[0].photo && page.views[0].scan);
  EXPECT_THAT(page.views[0].photo->dots, IsEmpty());
  EXPECT_THAT(page.views[0].scan->colour, IsEmpty());
  const std::string html = FormatPage(page);
  EXPECT_THAT(html, HasSubstr("No transform was found"));
  EXPECT_THAT(html, Not(HasSubstr("camera_from_lidar")));
}

TEST(PoseInWords, NamesTheDirectionsOfTheLidar) {
  Eigen::Matrix3d axes;
  axes << 0, -1, 0, 0, 0, -1, 1, 0, 0;
  const Rigid3d lidar_from_cam{
      Eigen::Quaterniond(Eigen::AngleAxisd(5.0 * kRadPerDeg, Eigen::Vector3d::UnitZ()) *
                         axes.transpose()),
      {0.1, -0.2, -0.03}};
  const std::string words = PoseInWords(lidar_from_cam.Inverse());
  EXPECT_THAT(words, HasSubstr("100 mm in front of, 200 mm to the right of and 30 mm below"));
  EXPECT_THAT(words, HasSubstr("5.0 deg to the left and 0.0 deg"));
  const Rigid3d rolled{
      lidar_from_cam.rotation * Eigen::AngleAxisd(3.0 * kRadPerDeg, Eigen::Vector3d::UnitZ()),
      Eigen::Vector3d::Zero()};
  EXPECT_THAT(PoseInWords(rolled.Inverse()), HasSubstr("3.0 deg clockwise"));
}

TEST(FileHash, AgreesWithTheStandard) {
  constexpr const char* kAbc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
  EXPECT_EQ(HashOfBytes("abc"), kAbc);
  test::WriteText(test::TestPath("abc"), "abc");
  EXPECT_EQ(HashOfFile(test::TestPath("abc")), kAbc);
  EXPECT_EQ(HashOfFile(test::TestPath("absent")), std::nullopt);
  EXPECT_EQ(HashOfFile(test::TestFolder()), std::nullopt);
}

TEST(FileHash, ReadsAFileAgainOnlyWhereItsSizeOrTimeDiffers) {
  const std::filesystem::path path = test::TestPath("scan");
  const auto now = std::filesystem::file_time_type::clock::now();
  const auto write = [&](const std::string& text, std::chrono::seconds age) {
    test::WriteText(path, text);
    std::filesystem::last_write_time(path, now - age);
  };
  const std::string abc = HashOfBytes("abc");
  write("abc", std::chrono::seconds(30));
  EXPECT_EQ(HashOfFile(path), abc);
  write("xyz", std::chrono::seconds(30));
  EXPECT_EQ(HashOfFile(path), abc);
  write("xyz", std::chrono::seconds(20));
  EXPECT_EQ(HashOfFile(path), HashOfBytes("xyz"));
  write("wxyz", std::chrono::seconds(20));
  EXPECT_EQ(HashOfFile(path), HashOfBytes("wxyz"));
}

TEST(UtcText, IsACalendarTime) {
  EXPECT_EQ(UtcText(1493815925.9), "2017-05-03 12:52:05 UTC");
  const std::chrono::sys_seconds time{std::chrono::seconds(1493815925)};
  EXPECT_EQ(UtcText(time), "2017-05-03 12:52:05 UTC");
  EXPECT_EQ(UtcIsoText(time), "2017-05-03T12:52:05Z");
  EXPECT_EQ(UtcText(std::chrono::sys_seconds{}), "1970-01-01 00:00:00 UTC");
  EXPECT_EQ(UtcText(12.0), "");
  EXPECT_EQ(UtcText(NAN), "");
  EXPECT_THAT(TodayText(), testing::MatchesRegex("2[0-9]+-[0-9]+-[0-9]+"));
}

}  // namespace
}  // namespace sextant
