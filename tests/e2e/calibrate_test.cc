// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "e2e/run_sextant.h"
#include "e2e/shared_session.h"
#include "e2e/swinging_scene.h"
#include "support/real_data.h"
#include "support/run_program.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

using nlohmann::json;
using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using test::WriteText;
using testing::AnyOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

constexpr const char* kCameraToCalibrate = R"(  - name: cam
    intrinsics: {model: pinhole, width_px: 960, height_px: 600, fx_px: 560, fy_px: 560, cx_px: 479.5, cy_px: 299.5}
    pose: {position_m: [0.05, 0.1, 0.92], yaw_deg: 2, pitch_deg: 1, roll_deg: -1}
)";

fs::path Simulated() {
  return test::SharedSession(test::SwingingScene("calibrate", kCameraToCalibrate),
                             "--interval 60 --scans 4");
}

std::size_t LongestLine(const std::string& text) {
  std::istringstream lines(text);
  std::size_t longest = 0;
  for (std::string line; std::getline(lines, line);) longest = std::max(longest, line.size());
  return longest;
}

std::string Out() { return " --out " + (TestFolder() / "result.yaml").string(); }

// The session of four scans calibrated with every output, in a folder of its own.
struct Calibrated {
  test::ScratchFolder folder{};
  ProgramRun run = RunSextant("calibrate " + Simulated().string() + " --bootstrap 30 --out " +
                              In("result.yaml") + " --json " + In("result.json") + " --report " +
                              In("report.html"));

  std::string In(const char* name) const { return (folder.path() / name).string(); }
};

// Once per process.
const Calibrated& CalibratedSession() {
  static const Calibrated calibrated;
  return calibrated;
}

TEST(Calibrate, ASimulatedSessionAsItStands) {
  const Calibrated& calibrated = CalibratedSession();
  const ProgramRun& run = calibrated.run;
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, HasSubstr("error against the truth"));
  EXPECT_THAT(run.out, HasSubstr("cam_from_lidar maps a point of the LiDAR frame"));
  EXPECT_THAT(run.out, AnyOf(StartsWith("GOOD: "), StartsWith("USABLE WITH CARE: ")));
  EXPECT_THAT(test::Unbroken(run.out), HasSubstr("It rests on 8 boards in 4 of 4 views"));
  EXPECT_LE(LongestLine(run.out), 100U);
  EXPECT_THAT(run.out, Not(HasSubstr("ambiguous")));
  const std::string text = ReadText(calibrated.In("result.json"));
  const json result = json::parse(text);
  EXPECT_EQ(result["views"].size(), 4U);
  EXPECT_THAT(run.out, StartsWith(result["verdict"]["word"].get<std::string>() + ": "));
  EXPECT_THAT(ReadText(calibrated.In("result.yaml")), HasSubstr("cam_from_lidar"));
  // Again: the same bytes.
  RunSextant("calibrate " + Simulated().string() + " --bootstrap 30 --out " +
             calibrated.In("again.yaml") + " --json " + calibrated.In("again.json"));
  EXPECT_EQ(text, ReadText(calibrated.In("again.json")));

  // With other solvers for comparison.
  const fs::path session = test::CopyOfSession(Simulated());
  const ProgramRun compared = RunSextant("calibrate " + session.string() + Out() +
                                         " --solver 'gnc(kabsch),kabsch,epnp' --bootstrap 0");
  EXPECT_EQ(compared.exit_code, 0) << compared.err;
  EXPECT_THAT(compared.out, HasSubstr("to first"));

  // The third image with the scan of the first.
  fs::copy_file(session / "scan_000.pcd", session / "scan_002.pcd",
                fs::copy_options::overwrite_existing);
  const ProgramRun mixed = RunSextant("calibrate " + session.string() + Out() + " --bootstrap 30");
  EXPECT_EQ(mixed.exit_code, 0) << mixed.err;
  EXPECT_THAT(test::Unbroken(mixed.out), HasSubstr("image and scan of different moments"));
  EXPECT_THAT(mixed.out, StartsWith("USABLE WITH CARE: In 1 of 4 views"));
}

// The same calibration twice: with all that a calibration knows, and from its result alone.
TEST(Calibrate, TheReportHoldsTheViewsWithPhotosAndScans) {
  const Calibrated& calibrated = CalibratedSession();
  const ProgramRun& run = calibrated.run;
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, HasSubstr("report.html: the report, one file"));
  const std::string full = ReadText(calibrated.In("report.html"));
  const std::string path = (TestFolder() / "report.html").string();
  EXPECT_THAT(full, HasSubstr(run.out.substr(0, run.out.find(':'))));
  for (const char* part :
       {"id=\"view-3\"", "data:image/jpeg;base64,", "data:image/png;base64,", "edge_growth_along_m",
        "gnc(kabsch)", "cam_000.png", "scan_003.pcd", "Hold board", "\"xyz\":"}) {
    EXPECT_THAT(full, HasSubstr(part)) << part;
  }
  const ProgramRun again = RunSextant("report " + calibrated.In("result.yaml") + " --out " + path);
  ASSERT_EQ(again.exit_code, 0) << again.err;
  const std::string from_result = ReadText(path);
  EXPECT_THAT(from_result, HasSubstr("data:image/jpeg;base64,"));
  EXPECT_THAT(from_result, HasSubstr("Result files do not contain the nuisance parameters"));
  EXPECT_LT(from_result.size(), full.size());
  const ProgramRun absent = RunSextant("report " + (TestFolder() / "absent.yaml").string());
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_THAT(absent.err, HasSubstr("run sextant calibrate --report"));
}

TEST(Calibrate, TheProblemFileGivesTheSameAnswerToSolve) {
  const fs::path session = Simulated();
  const std::string problem = (TestFolder() / "problem.yaml").string();
  const fs::path calibrated = TestFolder() / "calibrated.json";
  const std::string solver = " --solver 'joint(gnc(kabsch),board_size=scale)'";
  const ProgramRun run =
      RunSextant("calibrate " + session.string() + Out() + solver + " --bootstrap 0 --problem " +
                 problem + " --json " + calibrated.string());
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  const fs::path solved = TestFolder() / "solved.json";
  const ProgramRun again = RunSextant("solve " + problem + solver + " --json " + solved.string());
  ASSERT_EQ(again.exit_code, 0) << again.err << again.out;
  EXPECT_EQ(json::parse(ReadText(solved)).at("results").at(0).at("cam_from_lidar"),
            json::parse(ReadText(calibrated)).at("cam_from_lidar"));
  const ProgramRun nowhere =
      RunSextant("calibrate " + session.string() + Out() + " --problem /proc/none/problem.yaml");
  EXPECT_EQ(nowhere.exit_code, 4);
  EXPECT_THAT(nowhere.err, HasSubstr("/proc/none/problem.yaml"));
}

TEST(Calibrate, OnePairOfFilesWarnsOfTheSingleView) {
  const fs::path session = Simulated();
  const std::string files = " --image " + (session / "cam_000.png").string() + " --cloud " +
                            (session / "scan_000.pcd").string() + " --camera " +
                            (session / "cam_info.yaml").string();
  const ProgramRun run =
      RunSextant("calibrate" + files + " --board " + (session / "boards.yaml").string() + Out());
  ASSERT_EQ(run.exit_code, 0) << run.err << run.out;
  EXPECT_THAT(run.out, HasSubstr("one view only"));
  EXPECT_THAT(run.out, Not(StartsWith("GOOD")));

  // A board file whose tags are a tenth too large.
  std::string boards = ReadText(session / "boards.yaml");
  for (std::size_t at = boards.find("0.205"); at != std::string::npos;
       at = boards.find("0.205", at + 1)) {
    boards.replace(at, 5, "0.226");
  }
  WriteText(TestFolder() / "wrong.yaml", boards);
  const ProgramRun wrong = RunSextant("calibrate" + files + " --board " +
                                      (TestFolder() / "wrong.yaml").string() + Out());
  EXPECT_EQ(wrong.exit_code, 3) << wrong.err;
  EXPECT_THAT(wrong.out, StartsWith("NOT USABLE: Boards are "));
  EXPECT_THAT(wrong.out, HasSubstr("board file: distances in the images are"));
  EXPECT_THAT(ReadText(TestFolder() / "result.yaml"), HasSubstr("NOT USABLE"));
}

TEST(Calibrate, TheNeedDecidesTheVerdict) {
  const fs::path session = Simulated();
  const ProgramRun run =
      RunSextant("calibrate " + session.string() + Out() + " --need 0.001,0.1 --bootstrap 30");
  EXPECT_EQ(run.exit_code, 3) << run.err;
  EXPECT_THAT(run.out, StartsWith("NOT USABLE: The least certain direction is known to"));
  const std::string result = (TestFolder() / "result.yaml").string();
  const ProgramRun refused = RunSextant("export " + result + " --to matrix");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.err, HasSubstr("add --force"));
  EXPECT_EQ(RunSextant("export " + result + " --to matrix --force").exit_code, 0);
  const ProgramRun advice = RunSextant("advise " + result);
  EXPECT_EQ(advice.exit_code, 0) << advice.err;
  EXPECT_THAT(advice.out, StartsWith("NOT USABLE: "));
  const ProgramRun wrong = RunSextant("calibrate " + session.string() + Out() + " --need 10");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("--need"));
}

TEST(Calibrate, NoCommonBoardEndsInOne) {
  const fs::path session = test::CopyOfSession(Simulated());
  for (const char* view : {"_001", "_002", "_003"}) {
    fs::remove(session / ("cam" + std::string(view) + ".png"));
    fs::remove(session / ("scan" + std::string(view) + ".pcd"));
  }
  std::string boards = ReadText(session / "boards.yaml");
  for (const char* id : {"id: 26", "id: 582"}) {
    const std::size_t at = boards.find(id);
    ASSERT_NE(at, std::string::npos);
    boards.replace(at, std::string(id).size(), std::string(id).replace(4, 1, "7"));
  }
  WriteText(session / "boards.yaml", boards);
  const std::string page = (TestFolder() / "report.html").string();
  const ProgramRun run = RunSextant("calibrate " + session.string() + Out() + " --report " + page);
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.err, HasSubstr("no board was seen by both sensors"));
  EXPECT_THAT(run.err, HasSubstr("was not found"));
  EXPECT_THAT(ReadText(page), HasSubstr("<strong>NOT USABLE</strong>"));
  EXPECT_THAT(ReadText(page), Not(HasSubstr("camera_from_lidar")));
  // There is no JSON, and nothing else in its place.
  const ProgramRun to_pipe = RunSextant("calibrate " + session.string() + Out() + " --json -");
  EXPECT_EQ(to_pipe.exit_code, 1);
  EXPECT_EQ(to_pipe.out, "");
  EXPECT_THAT(to_pipe.err, HasSubstr("no board was seen by both sensors"));
}

TEST(Calibrate, TheResultIsWrittenIfTheProblemCannotBe) {
  const std::string out = (TestFolder() / "result.yaml").string();
  const ProgramRun run = RunSextant("calibrate " + Simulated().string() +
                                    " --bootstrap 0 --problem /dev/full --out " + out);
  EXPECT_EQ(run.exit_code, 4) << run.err;
  EXPECT_THAT(run.err, HasSubstr("/dev/full"));
  EXPECT_TRUE(fs::exists(out));
  EXPECT_THAT(run.out, HasSubstr("cam_from_lidar"));
}

// An unreadable view is left out; a scan that is also the output must not be, and be replaced.
TEST(Calibrate, AnOutputThatIsAScanIsRefused) {
  const fs::path session = test::CopyOfSession(Simulated());
  const fs::path scan = session / "scan_001.pcd";
  const std::string before = ReadText(scan);
  for (const char* option : {" --out ", " --json ", " --problem ", " --report "}) {
    const ProgramRun run =
        RunSextant("calibrate " + session.string() + " --overwrite" + option + scan.string());
    EXPECT_EQ(run.exit_code, 2) << option << run.out;
    EXPECT_THAT(run.err, HasSubstr("it is also an output of the same command")) << option;
    EXPECT_TRUE(ReadText(scan) == before) << option;
  }
  const ProgramRun boards = RunSextant(
      "boards " + (session / "scan_000.pcd").string() + " " + scan.string() + " --board " +
      (session / "boards.yaml").string() + " --overwrite --json " + scan.string());
  EXPECT_EQ(boards.exit_code, 2);
  EXPECT_TRUE(ReadText(scan) == before);
}

TEST(Calibrate, WrongUseIsReported) {
  const ProgramRun nothing = RunSextant("calibrate");
  EXPECT_EQ(nothing.exit_code, 2);
  EXPECT_THAT(nothing.err, HasSubstr("--image"));
  const ProgramRun half = RunSextant("calibrate --image a.png");
  EXPECT_EQ(half.exit_code, 2);
  EXPECT_THAT(half.err, HasSubstr("--cloud is missing"));
  const ProgramRun unknown = RunSextant("calibrate --image a.png --cloud a.pcd");
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_THAT(unknown.err, HasSubstr("--board is missing"));
}

}  // namespace
}  // namespace sextant
