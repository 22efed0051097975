// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "e2e/run_sextant.h"
#include "e2e/shared_session.h"
#include "e2e/swinging_scene.h"
#include "io/clouds/cloud_file.h"
#include "io/results/rig_result.h"
#include "support/real_data.h"
#include "support/run_program.h"
#include "support/scratch_folder.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::RunSextant;
using test::TestPath;
using testing::HasSubstr;

constexpr const char* kCameras = R"(  - name: left
    intrinsics: {model: pinhole, width_px: 960, height_px: 600, fx_px: 560, fy_px: 560, cx_px: 479.5, cy_px: 299.5}
    pose: {position_m: [0.05, 0.2, 0.92], yaw_deg: 2, pitch_deg: 1, roll_deg: -1}
  - name: right
    intrinsics: {model: pinhole, width_px: 960, height_px: 600, fx_px: 560, fy_px: 560, cx_px: 479.5, cy_px: 299.5}
    pose: {position_m: [0.05, -0.2, 0.92], yaw_deg: -2, pitch_deg: 0, roll_deg: 1}
)";

std::filesystem::path SessionOfRig() {
  return test::SharedSession(test::SwingingScene("rig", kCameras), "--interval 60 --scans 3");
}

// The session solved as a rig, with the problem that it wrote.
struct SolvedRig {
  test::ScratchFolder folder{};
  std::string out = (folder.path() / "rig.json").string();
  std::string problem = (folder.path() / "rig.yaml").string();
  ProgramRun run = RunSextant("calibrate " + SessionOfRig().string() + " --out " + out +
                              " --problem " + problem);
};

// Once per process; tests do not change it.
const SolvedRig& Solved() {
  static const SolvedRig solved;
  return solved;
}

TEST(RigCommand, ASessionOfSeveralCamerasIsSolvedAsOneRig) {
  const ProgramRun& run = Solved().run;
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("left_from_right"));
  const json rig = json::parse(test::ReadText(Solved().out));
  ASSERT_EQ(rig["sensors"].size(), 3U);
  for (const json& sensor : rig["sensors"]) {
    const auto at = sensor["root_from_sensor"]["translation_m"].get<std::vector<double>>();
    const auto truth = sensor["true_root_from_sensor"]["translation_m"].get<std::vector<double>>();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(at[k], truth[k], 0.02) << sensor["name"];
    EXPECT_GE(sensor["views_used"].get<int>(), 4) << sensor["name"];
  }
  ASSERT_EQ(rig["pairs"].size(), 3U);
  for (const json& pair : rig["pairs"]) {
    EXPECT_LT(pair["alone"]["off_sigmas"].get<double>(), 3.0) << pair["a"] << pair["b"];
  }
  // The problem that it wrote has the same answer.
  const ProgramRun again =
      RunSextant("rig " + Solved().problem + " --out " + TestPath("again.json"));
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const json same = json::parse(test::ReadText(TestPath("again.json")));
  for (std::size_t s = 0; s < 3; ++s) {
    for (std::size_t k = 0; k < 3; ++k) {
      const char* key = "root_from_sensor";
      EXPECT_NEAR(same["sensors"][s][key]["translation_m"][k].get<double>(),
                  rig["sensors"][s][key]["translation_m"][k].get<double>(), 1e-6);
    }
  }
}

TEST(RigCommand, ARigIsExportedAsATreeOrAPair) {
  const std::string& out = Solved().out;
  ASSERT_EQ(Solved().run.exit_code, 0);
  const ProgramRun tree = RunSextant("export " + out + " --to ros2");
  ASSERT_EQ(tree.exit_code, 0) << tree.err;
  EXPECT_THAT(tree.out, HasSubstr("'--child-frame-id', 'right'"));
  EXPECT_THAT(tree.out, HasSubstr("'--child-frame-id', 'left'"));
  const ProgramRun pair = RunSextant("export " + out + " --sensors left lidar --to matrix");
  ASSERT_EQ(pair.exit_code, 0) << pair.err;
  EXPECT_THAT(pair.out, HasSubstr("left"));
  const ProgramRun none = RunSextant("export " + out + " --sensors left top --to matrix");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("there are: lidar, left, right"));
  for (const char* option : {"--lidar-frame velodyne", "--camera-frame cam", "--parent camera"}) {
    const std::string command = "export " + out + " --to ros2 " + option;
    test::ExpectRefused(RunSextant(command), "is for two sensors");
    EXPECT_EQ(RunSextant(command + " --sensors left lidar").exit_code, 0) << option;
  }
}

TEST(RigCommand, AScanIsDrawnOnTheImageOfANamedCamera) {
  const std::string& rig = Solved().out;
  ASSERT_EQ(Solved().run.exit_code, 0);
  const std::string folder = SessionOfRig().string();
  const auto project = [&](const std::string& options) {
    return RunSextant("project --image " + folder + "/right_001.png --cloud " + folder +
                      "/scan_001.pcd --result " + rig + " --overwrite --out " +
                      TestPath("seen.png") + " --board " + folder + "/boards.yaml " + options);
  };
  // The only LiDAR need not be named. The board's outlines by both sensors lie on each other.
  const ProgramRun right = project("--camera-name right");
  ASSERT_EQ(right.exit_code, 0) << right.err;
  const std::string mark = "(white) ";
  ASSERT_THAT(right.out, HasSubstr(mark));
  EXPECT_LT(std::stod(right.out.substr(right.out.find(mark) + mark.size())), 30.0) << right.out;
  test::ExpectRefused(project(""), "choose one with --camera-name; there are: lidar, left, right");
  test::ExpectRefused(project("--camera-name middle"),
                      "no sensor 'middle'; there are: lidar, left, right");
  test::ExpectRefused(project("--camera-name left --lidar-name left"), "got 'left' twice");
  test::ExpectRefused(
      RunSextant("project --image a.png --cloud a.pcd --camera-name left --result " + folder +
                 "/boards.yaml --out " + TestPath("seen.png")),
      "leave them out");
}

TEST(RigCommand, CloudsOfNamedSensorsAreFused) {
  // top 1 m above the base, turned by 90 degrees about z; rear 2 m behind it.
  RigResult result{.version = "1", .root = "base"};
  result.sensors.push_back({.name = "base", .root_from_sensor = Rigid3d{}});
  result.sensors.push_back(
      {.name = "top",
       .root_from_sensor =
           Rigid3d{Eigen::Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5)), {0, 0, 1}}});
  result.sensors.push_back(
      {.name = "rear", .root_from_sensor = Rigid3d{Eigen::Quaterniond::Identity(), {-2, 0, 0}}});
  std::ofstream(TestPath("rig.json")) << FormatRigResult(result);
  std::ofstream(TestPath("top.csv")) << "x,y,z\n1,0,0\n";
  std::ofstream(TestPath("rear.csv")) << "x,y,z\n5,0,0\n";
  const std::string fuse = "fuse " + TestPath("top.csv") + " " + TestPath("rear.csv") +
                           " --overwrite --out " + TestPath("both.pcd");
  const std::string rig = " --result " + TestPath("rig.json");
  const ProgramRun run = RunSextant(fuse + rig + " --sensors top rear");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const auto fused = ReadCloud(TestPath("both.pcd"));
  ASSERT_TRUE(fused);
  ASSERT_EQ(fused->points.size(), 2U);
  EXPECT_LT((fused->points[0] - Eigen::Vector3d(2, 1, 1)).norm(), 1e-6);
  EXPECT_LT((fused->points[1] - Eigen::Vector3d(5, 0, 0)).norm(), 1e-6);
  test::ExpectRefused(RunSextant(fuse + rig + " --sensors top front"),
                      "no sensor 'front'; there are: base, top, rear");
  test::ExpectRefused(RunSextant(fuse + rig + " --sensors top"),
                      "expected the sensor of each of the 2 clouds");
  test::ExpectRefused(RunSextant(fuse + " --sensors top rear"), "--sensors needs --result");
  test::ExpectRefused(RunSextant(fuse + " --sensors top rear --result " + TestPath("top.csv")),
                      "expected rig.json");
  test::ExpectRefused(RunSextant(fuse + rig + " --sensors top rear --pose-is lidar_from_cam"),
                      "--pose-is has no effect with --result");
  test::ExpectRefused(
      RunSextant("export " + TestPath("rig.json") + " --to ros2 --pose-is lidar_from_cam"),
      "--pose-is has no effect on a rig's result");
  result.sensors.push_back({.name = "lost"});
  result.unconnected = {"'lost' shares no board with another sensor"};
  std::ofstream(TestPath("part.json")) << FormatRigResult(result);
  const ProgramRun part = RunSextant("export " + TestPath("part.json") + " --to ros2");
  EXPECT_EQ(part.exit_code, 0) << part.err;
  EXPECT_THAT(part.err, HasSubstr("warning: 'lost' shares no board"));
}

TEST(RigCommand, OptionsOfOneCameraAndOneLidarAreRefused) {
  const std::string calibrate =
      "calibrate " + SessionOfRig().string() + " --out " + TestPath("out.json");
  for (const std::string option : {"--need 5,0.05", "--bootstrap 0", "--tolerance 0.05",
                                   "--solver kabsch", "--image-topic /left"}) {
    test::ExpectRefused(RunSextant(calibrate + " " + option),
                        option.substr(0, option.find(' ')) + " is for one camera and one LiDAR");
  }
  ASSERT_EQ(Solved().run.exit_code, 0);
  for (const std::string option : {"--pixel-sigma 0.3", "--count 1", "--lidar vlp16"}) {
    test::ExpectRefused(RunSextant("advise " + Solved().problem + " " + option),
                        option.substr(0, option.find(' ')) + " is for a result of one camera");
  }
}

TEST(RigCommand, APathThatIsGivenIsKeptAlsoWhereItIsTheDefaultOfOthers) {
  const std::string cd = "cd " + test::TestFolder().string() + " && ";
  const ProgramRun run =
      test::RunProgram(cd, SEXTANT_BINARY " calibrate " + SessionOfRig().string() +
                               " --out result.yaml --problem /dev/full");
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.out, HasSubstr("left_from_right")) << "the answer does not need the problem";
  EXPECT_TRUE(std::filesystem::exists(TestPath("result.yaml")));
  EXPECT_FALSE(std::filesystem::exists(TestPath("rig.json")));
}

TEST(RigCommand, AWrongSizeOfTheTagIsNotUsable) {
  const std::string out = TestPath("wrong.json");
  ASSERT_EQ(Solved().run.exit_code, 0);
  std::string text = test::ReadText(Solved().problem);
  // The printed points as if the tags were a quarter larger.
  const std::string corners =
      "[-0.1025, -0.1025, 0.1025, -0.1025, 0.1025, 0.1025, -0.1025, 0.1025]";
  const std::string larger = "[-0.128, -0.128, 0.128, -0.128, 0.128, 0.128, -0.128, 0.128]";
  for (std::size_t at = text.find(corners); at != std::string::npos; at = text.find(corners)) {
    text.replace(at, corners.size(), larger);
  }
  ASSERT_NE(text, test::ReadText(Solved().problem));
  const std::string wrong = TestPath("wrong.yaml");
  std::ofstream(wrong) << text;
  const ProgramRun run = RunSextant("rig " + wrong + " --out " + out);
  EXPECT_EQ(run.exit_code, 3) << run.out;
  EXPECT_THAT(run.out, HasSubstr("NOT USABLE"));
  EXPECT_EQ(RunSextant("export " + out + " --to ros2").exit_code, 3);
  EXPECT_EQ(RunSextant("export " + out + " --to ros2 --force").exit_code, 0);
  const std::string folder = SessionOfRig().string();
  const ProgramRun drawn = RunSextant("project --image " + folder + "/left_001.png --cloud " +
                                      folder + "/scan_001.pcd --camera-name left --result " + out +
                                      " --out " + TestPath("seen.png"));
  EXPECT_THAT(drawn.out, testing::StartsWith("NOT USABLE"));
}

TEST(RigCommand, OneCameraOfSeveralIsCalibratedAlone) {
  const std::string out = TestPath("left.yaml");
  const ProgramRun run = RunSextant("calibrate " + SessionOfRig().string() +
                                    " --camera-name left --bootstrap 0 --out " + out);
  EXPECT_THAT(test::ReadText(out), HasSubstr("cam_from_lidar")) << run.err;
}

TEST(RigCommand, TheExampleOfFeaturesInTablesIsSolved) {
  // examples/rig has pixels of a camera, corners of one LiDAR, and planes and sides of another.
  const std::filesystem::path example = test::SourceRoot() / "examples/rig";
  const std::string out = TestPath("rig.json");
  const ProgramRun run = RunSextant("rig " + (example / "rig.yaml").string() + " --out " + out);
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const json rig = json::parse(test::ReadText(out));
  // The true positions by which the tables were made, in the frame of top.
  const Eigen::Vector3d truths[] = {
      {0.0547, 0.2085, -0.0810}, {0.0, 0.0, 0.0}, {-1.2021, 0.0399, -0.0841}};
  for (std::size_t s = 0; s < 3; ++s) {
    const json& sensor = rig["sensors"][s];
    const auto at = sensor["root_from_sensor"]["translation_m"].get<std::vector<double>>();
    double sigma = 0.0;
    if (s != 1) {
      for (std::size_t k = 3; k < 6; ++k)
        sigma += std::pow(sensor["sigma_rad_m"][k].get<double>(), 2);
    }
    const double off = (Eigen::Vector3d(at[0], at[1], at[2]) - truths[s]).norm();
    EXPECT_LT(off, 3.5 * std::sqrt(sigma) + 1e-9) << sensor["name"];
    EXPECT_LT(std::sqrt(sigma), 0.02) << sensor["name"];
  }
  // docs/rigs.md shows the files as they are.
  const std::string page = test::ReadText(test::SourceRoot() / "docs/rigs.md");
  EXPECT_THAT(page, HasSubstr(test::ReadText(example / "rig.yaml")));
  for (const char* table : {"pixels.csv", "points.csv", "planes.csv", "sides.csv"}) {
    const std::string text = test::ReadText(example / table);
    const std::size_t second = text.find('\n', text.find('\n') + 1);
    EXPECT_THAT(page, HasSubstr(text.substr(0, second + 1))) << table;
  }
}

// Corners of a board that moves, by two LiDARs at 10 Hz; the clock of rear is 15 ms ahead.
std::string TableOfMovingBoard(double speed_m_s) {
  std::string table = "time_s,sensor,corner,x,y,z\n";
  const Eigen::Vector3d corners[] = {
      {-0.4, -0.3, 0}, {0.4, -0.3, 0}, {0.4, 0.3, 0}, {-0.4, 0.3, 0}};
  Eigen::Matrix3d facing;
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Rigid3d rear_from_top{Eigen::Quaterniond(0, 0, 0, 1), {-1.0, 0.1, 0.2}};
  for (int moment = 0; moment < 8; ++moment) {
    const Eigen::Vector3d velocity =
        speed_m_s * Eigen::Vector3d(std::sin(moment), std::cos(moment), 0.5).normalized();
    const Eigen::Quaterniond turned(
        Eigen::AngleAxisd(0.4 * std::sin(2.0 * moment), Eigen::Vector3d(0, 0.5, 1).normalized()) *
        Eigen::Quaterniond(facing));
    for (int k = 0; k < 6; ++k) {
      const bool rear = k % 2 == 1;
      const double time_s = 10.0 * moment + 0.1 * (k / 2) + (rear ? 0.04 : 0.0);
      const Rigid3d top_from_board{turned, Eigen::Vector3d(3.0 + 0.2 * (moment % 3), 0.3, 0.1) +
                                               time_s * velocity - 10.0 * moment * velocity};
      for (int corner = 0; corner < 4; ++corner) {
        Eigen::Vector3d point = top_from_board * corners[corner];
        if (rear) point = rear_from_top * point;
        table += std::to_string(time_s + (rear ? 0.015 : 0.0)) + (rear ? ",rear," : ",top,") +
                 std::to_string(corner) + "," + std::to_string(point.x()) + "," +
                 std::to_string(point.y()) + "," + std::to_string(point.z()) + "\n";
      }
    }
  }
  return table;
}

TEST(RigCommand, ClocksAreEstimatedFromBoardsThatMove) {
  test::WriteText(TestPath("rig.yaml"),
                  "sextant_rig: 1\nsensors: [{name: top}, {name: rear}]\n"
                  "boards: [{id: 0, top_right_m: 0.8, right_bottom_m: 0.6}]\n"
                  "tables: corners.csv\n");
  const std::string command =
      "rig " + TestPath("rig.yaml") + " --estimate-time --overwrite --out " + TestPath("rig.json");
  test::WriteText(TestPath("corners.csv"), TableOfMovingBoard(0.4));
  const ProgramRun run = RunSextant(command);
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const json rig = json::parse(test::ReadText(TestPath("rig.json")));
  EXPECT_EQ(rig["views"].size(), 8U);
  bool found = false;
  for (const json& number : rig["numbers"]) {
    if (number["name"] != "time_offset_s") continue;
    found = true;
    EXPECT_EQ(number["sensor"], "rear");
    EXPECT_NEAR(number["value"].get<double>(), 0.015, 2e-4);
    EXPECT_LT(number["sigma"].get<double>(), 0.01);
  }
  EXPECT_TRUE(found);
  test::WriteText(TestPath("corners.csv"), TableOfMovingBoard(0.0));
  const ProgramRun still = RunSextant(command);
  EXPECT_EQ(still.exit_code, 0) << still.err;
  EXPECT_THAT(still.out, HasSubstr("does not determine the time offset of rear"));
}

// Two corners of one sensor are exchanged.
TEST(RigCommand, WrongDataIsWrongUseWhoeverReadsIt) {
  test::WriteText(TestPath("rig.yaml"),
                  "sextant_rig: 1\nsensors: [{name: top}, {name: rear}]\n"
                  "boards: [{id: 0, top_right_m: 0.8, right_bottom_m: 0.6}]\n"
                  "tables: corners.csv\n");
  std::string table = TableOfMovingBoard(0.0);
  const auto replace = [&table](const std::string& from, const std::string& to) {
    for (std::size_t at = table.find(from); at != std::string::npos; at = table.find(from, at)) {
      table.replace(at, from.size(), to);
    }
  };
  replace(",rear,2,", ",rear,x,");
  replace(",rear,3,", ",rear,2,");
  replace(",rear,x,", ",rear,3,");
  test::WriteText(TestPath("corners.csv"), table);
  test::ExpectRefused(RunSextant("rig " + TestPath("rig.yaml") + " --out " + TestPath("rig.json")),
                      "its points do not have the form of the board");
  test::ExpectRefused(RunSextant("advise " + TestPath("rig.yaml")),
                      "its points do not have the form of the board");
}

TEST(RigCommand, ReadsTheTransformsOfTheOriginalPackage) {
  SEXTANT_REAL_DATA(path, "dhall/rts.txt");
  const std::string out = TestPath("rig.json");
  const ProgramRun run = RunSextant("rig " + path.string() + " --out " + out);
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("camera_1_from_camera_2"));
  const json rig = json::parse(test::ReadText(out));
  const json& pair = rig["pairs"][2];
  EXPECT_EQ(pair["a"], "camera_1");
  // x of -0.14 and 0.257 m.
  EXPECT_NEAR(pair["a_from_b"]["translation_m"][0].get<double>(), -0.397, 1e-12);
}

TEST(RigCommand, OptionsForRigFilesAreRefusedForTransforms) {
  const std::string rts = TestPath("rts.txt");
  test::WriteText(rts,
                  "1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 0 0 0.4\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  const std::string command = "rig " + rts + " --overwrite --out " + TestPath("rig.json");
  EXPECT_EQ(RunSextant(command).exit_code, 0);
  test::ExpectRefused(RunSextant(command + " --root camera_1"), "--root is for a rig file");
  test::ExpectRefused(RunSextant(command + " --estimate-time"),
                      "--estimate-time is for a rig file");
  const ProgramRun full = RunSextant("rig " + rts + " --out /dev/full");
  EXPECT_EQ(full.exit_code, 4);
  EXPECT_THAT(full.out, HasSubstr("camera_1")) << "what cannot be written is still printed";
  // The fault of a matrix is named, and no rig file is expected.
  test::WriteText(rts, "1 0 0 0.1\n0 1 0 0\n0 0 2 0\n0 0 0 1\n");
  test::ExpectRefused(RunSextant(command), "expected a rotation");
}

TEST(RigCommand, TransformsHaveTheLimitOfRigFiles) {
  std::string matrices;
  for (int i = 0; i < 99; ++i) matrices += "1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const std::string rts = TestPath("rts.txt");
  const std::string command = "rig " + rts + " --overwrite --out " + TestPath("rig.json");
  test::WriteText(rts, matrices);
  EXPECT_EQ(RunSextant(command).exit_code, 0);
  test::WriteText(rts, matrices + "1 0 0 0.1\n0 1 0 0\n0 0 1 0\n0 0 0 1\n");
  test::ExpectRefused(RunSextant(command), "sensors: expected at most 100 items, got 101");
}

TEST(RigCommand, ASessionWithoutBoardsIsWrongUse) {
  const std::string folder = SessionOfRig().string();
  test::WriteText(TestPath("session.yaml"),
                  "sextant_session: 1\nsensors:\n"
                  "  - {name: lidar, clouds: '" +
                      folder +
                      "/scan_*.pcd'}\n"
                      "  - {name: left, camera: '" +
                      folder + "/left_info.yaml', images: '" + folder + "/left_*.png'}\n");
  test::ExpectRefused(
      RunSextant("calibrate " + TestPath("session.yaml") + " --out " + TestPath("rig.json")),
      "--board is missing");
}

}  // namespace
}  // namespace sextant
