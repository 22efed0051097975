// SPDX-License-Identifier: Apache-2.0
// The commands that use a result: project, export and advise.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <filesystem>
#include <opencv2/core.hpp>
#include <regex>
#include <sstream>
#include <string>

#include "calibrate/session/session.h"
#include "e2e/run_sextant.h"
#include "e2e/shared_session.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/results/calibration_result.h"
#include "support/pictures.h"
#include "support/run_program.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kSceneOfResult = R"(sextant_scene: 1
name: one board
lidar: {model: vlp16, pose: {position_m: [0, 0, 1]}}
cameras:
  - name: cam
    model: zed_left
    pose: {position_m: [0.05, 0.1, 0.9], yaw_deg: 2}
boards:
  - board: {id: 0, name: left, top_right_m: 0.5, right_bottom_m: 0.5, tags: [{family: aruco_original, id: 26, edge_m: 0.205}]}
    pose: {position_m: [2, 0.3, 1], yaw_deg: 10, pitch_deg: 5, roll_deg: 45}
walls:
  - {name: back, width_m: 8, height_m: 4, pose: {position_m: [4.4, 0, 1.5]}}
)";

// A simulated session, and a result with its true pose.
class ResultCommands : public testing::Test {
 protected:
  void SetUp() override {
    const auto session = ReadSession(Session());
    ASSERT_TRUE(session && session->true_cam_from_lidar);
    result_.version = "0.1.0";
    result_.solver = "truth";
    result_.cam_from_lidar = *session->true_cam_from_lidar;
    result_.camera = *ReadCamera(session->camera);
    result_.boards = *ReadBoards(session->boards);
    Write();
  }

  static std::string Session() { return test::SharedSession(kSceneOfResult).string(); }
  static std::string Result() { return (TestFolder() / "result.yaml").string(); }
  static std::string Picture() { return (TestFolder() / "out.png").string(); }
  void Write() const { WriteText(Result(), FormatCalibrationResult(result_)); }

  static ProgramRun Project(const std::string& more = "") {
    return RunSextant(
        fmt::format("project --image {0}/cam_000.png --cloud {0}/scan_000.pcd "
                    "--result {1} --out {2} {3}",
                    Session(), Result(), Picture(), more));
  }

  CalibrationResult result_;
};

double MillimetresApart(const std::string& text) {
  std::smatch match;
  EXPECT_TRUE(std::regex_search(text, match, std::regex("([0-9.]+) mm,"))) << text;
  return match.empty() ? -1.0 : std::stod(match[1]);
}

TEST_F(ResultCommands, ProjectDrawsTheScanAndBothOutlines) {
  const ProgramRun run = Project();
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("board left: its centre by image (orange) and scan (white)"));
  // With the true pose, the distance is the error of the extractors: millimetres.
  EXPECT_LT(MillimetresApart(run.out), 15.0);
  const cv::Mat picture = test::ReadPicture(Picture());
  ASSERT_EQ(picture.cols, result_.camera->width_px);
  // The board is nearest, so it is blue; the wall behind it is red.
  int blue = 0;
  int red = 0;
  for (const cv::Vec3b& p : cv::Mat_<cv::Vec3b>(picture)) {
    blue += p[0] > 200 && p[2] < 100 ? 1 : 0;
    red += p[2] > 150 && p[0] < 60 && p[1] < 60 ? 1 : 0;
  }
  EXPECT_GT(blue, 500);
  EXPECT_GT(red, 1000);
}

TEST_F(ResultCommands, ProjectShowsAWrongPose) {
  result_.cam_from_lidar.translation.x() += 0.2;
  Write();
  EXPECT_NEAR(MillimetresApart(Project().out), 200.0, 15.0);
  // With the camera turned around, no return is in the image.
  result_.cam_from_lidar.rotation = ExpSo3({0.0, 3.14159, 0.0}) * result_.cam_from_lidar.rotation;
  result_.boards.clear();
  Write();
  const ProgramRun nothing = Project();
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, HasSubstr("no return of"));
}

TEST_F(ResultCommands, ProjectReportsWhatDoesNotFit) {
  result_.camera->width_px = 640;
  Write();
  const ProgramRun wrong_size = Project();
  EXPECT_EQ(wrong_size.exit_code, 2);
  EXPECT_THAT(wrong_size.err, HasSubstr("pixels, the camera 640 x"));
  result_.camera.reset();
  Write();
  EXPECT_THAT(Project().err, HasSubstr("has no camera; expected its key 'camera', or --camera"));
}

TEST_F(ResultCommands, ExportWritesFilesThatOtherProgramsRead) {
  const std::string out = (TestFolder() / "extrinsic.yml").string();
  const ProgramRun run = RunSextant("export " + Result() + " --to opencv --out " + out);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  cv::FileStorage file(out, cv::FileStorage::READ);
  ASSERT_TRUE(file.isOpened());
  cv::Mat matrix;
  cv::Mat tvec;
  cv::Mat k;
  file["cam_from_lidar"] >> matrix;
  file["tvec_cam_from_lidar"] >> tvec;
  file["camera_matrix"] >> k;
  const Eigen::Vector3d in_cam = result_.cam_from_lidar * Eigen::Vector3d(2.0, 0.3, -0.1);
  const cv::Mat mapped = matrix * (cv::Mat_<double>(4, 1) << 2.0, 0.3, -0.1, 1.0);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(mapped.at<double>(i), in_cam[i], 1e-12);
  EXPECT_EQ(tvec.at<double>(2), result_.cam_from_lidar.translation.z());
  EXPECT_EQ(k.at<double>(0, 0), result_.camera->fx_px);
}

TEST_F(ResultCommands, ExportNamesFramesAndParents) {
  const ProgramRun named =
      RunSextant("export " + Result() + " --to ros1 --lidar-frame velodyne --camera-frame cam0");
  EXPECT_THAT(named.out, HasSubstr("velodyne cam0\" />"));
  const ProgramRun turned = RunSextant("export " + Result() + " --to urdf --parent camera");
  EXPECT_THAT(turned.out, AllOf(HasSubstr("<parent link=\"camera_optical_frame\""),
                                HasSubstr("camera_optical_frame_from_lidar")));
  const ProgramRun refused = RunSextant("export " + Result() + " --to kitti --parent camera");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("kitti always holds cam_from_lidar"));
  const ProgramRun unknown = RunSextant("export " + Result() + " --to rosl");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("did you mean 'ros1'?"));
}

TEST_F(ResultCommands, AdviseProposesAndDraws) {
  ResultView& view = result_.views.emplace_back();
  view.name = "first";
  view.boards.push_back(
      {.board = 0, .cam_from_board = Rigid3d{ExpSo3({0.0, 0.0, 0.785}), {0.1, 0.0, 2.0}}});
  Write();
  const ProgramRun run =
      RunSextant("advise " + Result() + " --count 2 --lidar vlp16 --picture " + Picture());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(test::Unbroken(run.out),
              AllOf(HasSubstr("cam_from_lidar after the one view"), HasSubstr("after first"),
                    HasSubstr("Hold board 0 (left) "),
                    HasSubstr("rings would cross it; predicted 1 sigma then")));
  std::istringstream lines(run.out);
  for (std::string line; std::getline(lines, line);) {
    // The path of the picture is as long as it is.
    if (line.starts_with(Picture())) continue;
    EXPECT_LE(line.size(), 100U) << line;
  }
  const cv::Mat picture = test::ReadPicture(Picture());
  EXPECT_GT(picture.cols, 1000);
}

TEST_F(ResultCommands, AdviseReportsWhatItNeeds) {
  const ProgramRun absent = RunSextant("advise " + Session());
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_THAT(absent.err, HasSubstr("run sextant calibrate first"));
  const std::string board = test::TestPath("board.yaml");
  test::WriteText(board, "id: 0\ntop_right_m: 1\nright_bottom_m: 1\n");
  EXPECT_THAT(RunSextant("advise " + board).err, HasSubstr("this is a board file"));
  const ProgramRun picture = RunSextant("advise " + Result() + " --picture /nowhere/a.png");
  EXPECT_EQ(picture.exit_code, 4);
  EXPECT_EQ(picture.out, "") << "before the work";
  EXPECT_THAT(picture.err, HasSubstr("cannot write '/nowhere/a.png'"));
  EXPECT_THAT(RunSextant("advise " + Result() + " --picture a.xyz").err,
              HasSubstr("a.xyz: expected an image that ends in .png or .jpg"));
  const ProgramRun lidar = RunSextant("advise " + Result() + " --lidar vlp61");
  EXPECT_EQ(lidar.exit_code, 2);
  EXPECT_THAT(lidar.err, HasSubstr("vlp16"));
}

}  // namespace
}  // namespace sextant
