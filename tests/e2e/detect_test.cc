// SPDX-License-Identifier: Apache-2.0
// `sextant detect` as a user runs it: rendered and real photos, and bad input of every kind.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>

#include "e2e/run_sextant.h"
#include "io/boards/board_file.h"
#include "simulator/camera/tag_picture.h"
#include "support/pictures.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::ReadText;
using test::TestPath;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

ProgramRun Detect(const std::string& arguments) { return test::RunSextant("detect " + arguments); }

// A board with one tag and its photo: photo.png, board.yaml and camera.yaml.
TagPicture MakePhoto() {
  const Expected<TagPicture> picture =
      RenderTagPicture({.side_px = 120.0,
                        .tilt_rad = 0.6,
                        .image = {.blur_sigma_px = 0.7, .noise_sigma_grey = 3.0}});
  EXPECT_TRUE(picture) << picture.error().message;
  EXPECT_TRUE(test::WritePicture(TestPath("photo.png"), picture->image));
  WriteText(TestPath("board.yaml"), FormatBoards({&picture->board, 1}));
  const Camera& camera = picture->camera;
  std::string text = "distortion_model: " +
                     std::string(camera.distortion[5] == 0.0 ? "plumb_bob" : "rational_polynomial");
  text += "\nimage_width: " + std::to_string(camera.width_px) +
          "\nimage_height: " + std::to_string(camera.height_px) + "\nK: [" +
          std::to_string(camera.fx_px) + ", 0, " + std::to_string(camera.cx_px) + ", 0, " +
          std::to_string(camera.fy_px) + ", " + std::to_string(camera.cy_px) + ", 0, 0, 1]\nD: [";
  for (std::size_t i = 0; i < 5; ++i) {
    text += (i > 0 ? ", " : "") + std::to_string(camera.distortion[i]);
  }
  WriteText(TestPath("camera.yaml"), text + "]\n");
  return *picture;
}

TEST(Detect, BoardPoseCornersAndOverlay) {
  const TagPicture picture = MakePhoto();
  const std::string arguments = TestPath("photo.png") + " --board " + TestPath("board.yaml") +
                                " --camera " + TestPath("camera.yaml");
  const ProgramRun run = Detect(arguments + " --overlay " + TestPath("overlay.png"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out,
              AllOf(HasSubstr("1 of 1 tags"), HasSubstr("cam_from_board"), HasSubstr("corner 3")));
  const cv::Mat overlay = test::ReadPicture(TestPath("overlay.png"));
  EXPECT_EQ(overlay.size(), picture.image.size());
  const ProgramRun lost = Detect(arguments + " --overlay " + TestPath("overlay.xyz"));
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.err, HasSubstr("overlay.xyz"));
  EXPECT_THAT(lost.out, HasSubstr("cam_from_board")) << "the answer does not need the overlay";

  const ProgramRun machine = Detect(arguments + " --json -");
  ASSERT_EQ(machine.exit_code, 0) << machine.err;
  const json board = json::parse(machine.out).at("images").at(0).at("boards").at(0);
  EXPECT_EQ(board.at("tags").at(0).at("id"), picture.board.tags[0].id);
  EXPECT_EQ(board.at("tags").at(0).at("covariance_px2").size(), 8U);
  EXPECT_EQ(board.at("corners_in_cam_m").size(), 4U);
  EXPECT_EQ(board.at("corners_covariance_m2").size(), 12U);
  const json& t = board.at("pose").at("cam_from_board").at("translation_m");
  const Eigen::Vector3d found(t.at(0).get<double>(), t.at(1).get<double>(), t.at(2).get<double>());
  EXPECT_LT((found - picture.cam_from_board.translation).norm(), 0.005);
}

TEST(Detect, WithoutABoardListsTheTagsOfAFamily) {
  MakePhoto();
  const ProgramRun run = Detect(TestPath("photo.png") + " --detector 'aruco(dictionary=original)'");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("tag 26 of aruco_original"));
  // The default family has no tag in it: the output names the family that has.
  const ProgramRun other = Detect(TestPath("photo.png"));
  EXPECT_EQ(other.exit_code, 1);
  EXPECT_THAT(other.out, AllOf(HasSubstr("no tag"), HasSubstr("aruco_original would find: 26")));
}

TEST(Detect, WithoutABoardListsTheCornersOfACheckerboard) {
  SEXTANT_REAL_DATA(image, "acfr_vlp16/images/pose5.png");
  const std::string arguments =
      image.string() + " --quick --json - --detector 'checkerboard(columns=";
  const ProgramRun run = Detect(arguments + "7,rows=5)'");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  const json found = json::parse(run.out).at("images").at(0).at("other_checkers");
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found.at(0).at("corners_px").size(), 35U);
  EXPECT_EQ(found.at(0).at("is_turn_known"), false);
  const ProgramRun people = Detect(image.string() + " --detector checkerboard");
  EXPECT_EQ(people.exit_code, 0) << people.err;
  EXPECT_THAT(people.out,
              AllOf(HasSubstr("checkerboard of 7 x 5 inner corners"), Not(HasSubstr("no tag"))));
  ASSERT_TRUE(test::WritePicture(TestPath("none.png"), cv::Mat(60, 80, CV_8U, cv::Scalar(90))));
  const ProgramRun none = Detect(TestPath("none.png") + " --quick --detector checkerboard");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.out, HasSubstr("no checkerboard"));
}

TEST(Detect, BadImagesAreNamedAndTheOthersStillRead) {
  MakePhoto();
  const cv::Mat photo = test::ReadPicture(TestPath("photo.png"), DecodedColor::kGrey);
  const std::string whole = ReadText(TestPath("photo.png"));
  WriteText(TestPath("cut.png"), whole.substr(0, whole.size() / 2));
  WriteText(TestPath("empty.png"), "");
  WriteText(TestPath("words.png"), "this is not an image");
  ASSERT_TRUE(test::WritePicture(TestPath("one.png"), cv::Mat(1, 1, CV_8U, cv::Scalar(0))));
  cv::Mat deep;
  photo.convertTo(deep, CV_16U, 257.0);
  ASSERT_TRUE(test::WritePicture(TestPath("deep.png"), deep));
  cv::Mat layers[] = {photo, photo, photo, cv::Mat(photo.size(), CV_8U, cv::Scalar(9))};
  cv::Mat alpha;
  cv::merge(layers, 4, alpha);
  ASSERT_TRUE(test::WritePicture(TestPath("alpha.png"), alpha));
  const std::string detector = " --detector 'aruco(dictionary=original)'";
  for (const char* good : {"deep.png", "alpha.png"}) {
    EXPECT_EQ(Detect(TestPath(good) + detector).exit_code, 0) << good;
  }
  for (const char* bad : {"cut.png", "empty.png", "words.png", "one.png", "absent.png"}) {
    const ProgramRun run = Detect(TestPath(bad) + detector);
    EXPECT_EQ(run.exit_code, 2) << bad;
    EXPECT_THAT(run.err, HasSubstr(bad));
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
  }
  const ProgramRun both = Detect(TestPath("cut.png") + " " + TestPath("photo.png") + detector);
  EXPECT_EQ(both.exit_code, 2);
  EXPECT_THAT(both.out, HasSubstr("tag 26"));
  EXPECT_THAT(both.err, HasSubstr("cut off"));
}

TEST(Detect, BadBoardsAndDetectorsAreRefused) {
  MakePhoto();
  const std::string photo = TestPath("photo.png");
  WriteText(TestPath("bad.yaml"),
            "id: 0\ntop_right_m: 0.3\nright_bottom_m: 0.3\ntags:\n"
            "  - {family: aruco_original, id: 1, edge_m: 0.2}\n"
            "  - {family: aruco_original, id: 2, edge_m: 0.2}\n");
  const ProgramRun overlapping = Detect(photo + " --board " + TestPath("bad.yaml"));
  EXPECT_EQ(overlapping.exit_code, 2);
  EXPECT_THAT(overlapping.err, HasSubstr("bad.yaml"));
  EXPECT_EQ(Detect(photo + " --detector arucoo").exit_code, 2);
  EXPECT_EQ(Detect(photo + " --overlay /nowhere/a.png").exit_code, 4);
  EXPECT_EQ(Detect("").exit_code, 2);
}

TEST(Detect, AWrongDictionaryIsReportedForARealPhoto) {
  SEXTANT_REAL_DATA(photo, "dhall/photos/setup_view1.jpg");
  WriteText(TestPath("board.yaml"),
            "id: 0\ntop_right_m: 0.4\nright_bottom_m: 0.4\ntags:\n"
            "  - {family: aruco_6x6_1000, id: 26, edge_m: 0.2}\n");
  const ProgramRun missing = Detect(photo.string() + " --board " + TestPath("board.yaml"));
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(
      missing.out,
      HasSubstr(
          "there is no tag of aruco_6x6_1000, but there are tags of aruco_original: 26, 582"));
}

TEST(Detect, ReportsThatThereIsNoTag) {
  ASSERT_TRUE(test::WritePicture(TestPath("none.png"), cv::Mat(300, 400, CV_8U, cv::Scalar(90))));
  const ProgramRun run = Detect(TestPath("none.png") + " --quick");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("no tag"), Not(HasSubstr("tag36h11:"))));
}

}  // namespace
}  // namespace sextant
