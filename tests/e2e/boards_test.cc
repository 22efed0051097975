// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "e2e/run_sextant.h"
#include "e2e/shared_session.h"
#include "support/pictures.h"
#include "support/run_program.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kSceneOfBoards = R"(sextant_scene: 1
name: two boards
lidar: {model: vlp16, pose: {position_m: [0, 0, 1]}}
cameras:
  - name: cam
    intrinsics: {model: pinhole, width_px: 160, height_px: 120, fx_px: 90, fy_px: 90, cx_px: 79.5, cy_px: 59.5}
    pose: {position_m: [0, 0.1, 0.9]}
boards:
  - board: {id: 0, top_right_m: 0.5, right_bottom_m: 0.5}
    pose: {position_m: [2, 0.5, 1], yaw_deg: 10, pitch_deg: 5, roll_deg: 45}
  - board: {id: 1, top_right_m: 0.5, right_bottom_m: 0.5}
    pose: {position_m: [2, -0.5, 1], yaw_deg: -10, pitch_deg: -5, roll_deg: 40}
)";

// Two scans of two boards, with the file of the boards beside them.
fs::path SimulatedScans() { return test::SharedSession(kSceneOfBoards, "--scans 2"); }

TEST(Boards, FindsThemInManyScansAndDrawsOne) {
  const fs::path session = SimulatedScans();
  const std::string boards = " --board " + (session / "boards.yaml").string();
  const std::string first = (session / "scan_000.pcd").string();
  const ProgramRun text =
      RunSextant("boards " + first + " " + (session / "scan_001.pcd").string() + boards);
  EXPECT_EQ(text.exit_code, 0) << text.err;
  EXPECT_THAT(text.out, HasSubstr("4 of 4 boards found in 2 scans, corners by rectangle"));

  const fs::path picture = TestFolder() / "scan.png";
  const ProgramRun run =
      RunSextant("boards " + first + boards + " --json - --overlay " + picture.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json result = json::parse(run.out);
  ASSERT_EQ(result["scans"].size(), 1U);
  const json& found = result["scans"][0]["boards"];
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0]["board"], 0);
  // The scene's position in the LiDAR frame: 2 m ahead, 0.5 m to the left.
  EXPECT_NEAR(found[0]["center_in_lidar_m"][0].get<double>(), 2.0, 0.03);
  EXPECT_NEAR(found[0]["center_in_lidar_m"][1].get<double>(), 0.5, 0.03);
  EXPECT_EQ(found[0]["corners"]["in_lidar_m"].size(), 4U);
  EXPECT_EQ(found[0]["corners"]["covariance_m2"].size(), 12U);
  EXPECT_FALSE(test::ReadPicture(picture.string()).empty());
  const ProgramRun lost =
      RunSextant("boards " + first + boards + " --overlay " + (TestFolder() / "scan.xyz").string());
  EXPECT_EQ(lost.exit_code, 2);
  EXPECT_THAT(lost.out, HasSubstr("2 of 2 boards found")) << "the answer does not need the overlay";
}

TEST(Boards, AMissingBoardIsReportedAndEndsInOne) {
  const fs::path session = SimulatedScans();
  WriteText(TestFolder() / "large.yaml", "id: 7\ntop_right_m: 0.8\nright_bottom_m: 0.8\n");
  const ProgramRun run = RunSextant("boards " + (session / "scan_000.pcd").string() + " --board " +
                                    (TestFolder() / "large.yaml").string());
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.out, AllOf(HasSubstr("board 7: not found"), HasSubstr("0.800 x 0.800 m")));
}

TEST(Boards, WrongInputEndsInTwo) {
  const fs::path session = SimulatedScans();
  const std::string scan = (session / "scan_000.pcd").string();
  const std::string boards = " --board " + (session / "boards.yaml").string();
  EXPECT_EQ(RunSextant("boards").exit_code, 2);
  EXPECT_EQ(RunSextant("boards " + scan).exit_code, 2);
  EXPECT_EQ(RunSextant("boards /nowhere.pcd" + boards).exit_code, 2);
  EXPECT_THAT(RunSextant("boards " + scan + boards + " --extractor lines").err,
              HasSubstr("no corner extractor 'lines'"));
  EXPECT_THAT(RunSextant("boards " + scan + boards + " --region 1 1 1 0 2 2").err,
              HasSubstr("along x"));
  WriteText(TestFolder() / "empty.pcd",
            "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 0\nHEIGHT 1\n"
            "POINTS 0\nDATA ascii\n");
  const ProgramRun empty = RunSextant("boards " + (TestFolder() / "empty.pcd").string() + boards);
  EXPECT_EQ(empty.exit_code, 2);
  EXPECT_THAT(empty.err, HasSubstr("empty.pcd"));
}

}  // namespace
}  // namespace sextant
