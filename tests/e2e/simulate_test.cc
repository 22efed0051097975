// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <opencv2/core.hpp>

#include "e2e/run_sextant.h"
#include "support/file_marks.h"
#include "support/pictures.h"
#include "support/run_program.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

using test::ProgramRun;
using test::ReadText;
using test::RunSextant;
using test::TestFolder;
using test::TestPath;
using test::WriteText;
using testing::HasSubstr;
using testing::Key;
using testing::UnorderedElementsAre;

// A small image, for a fast simulation.
constexpr const char* kSceneToSimulate = R"(sextant_scene: 1
name: small
lidar: {model: vlp16, pose: {position_m: [0, 0, 1]}}
cameras:
  - name: cam
    intrinsics: {model: pinhole, width_px: 160, height_px: 120, fx_px: 90, fy_px: 90, cx_px: 79.5, cy_px: 59.5}
    pose: {position_m: [0, 0.1, 0.9]}
boards:
  - board:
      {id: 0, top_right_m: 0.5, right_bottom_m: 0.5, tags: [{family: tag36h11, id: 3, edge_m: 0.3}]}
    pose: {position_m: [2, 0.4, 1], yaw_deg: 10, pitch_deg: 5, roll_deg: 45}
    swing: {axis_in_world: [0, 1, 0], amplitude_deg: 5, period_s: 1.3}
  - board: {id: 1, top_right_m: 0.5, right_bottom_m: 0.5, hole: {width_m: 0.2, height_m: 0.2}}
    pose: {position_m: [2.2, -0.5, 1.1], yaw_deg: -10, pitch_deg: -5, roll_deg: 40}
)";

std::string SceneFile(const std::string& text = kSceneToSimulate) {
  const fs::path path = TestFolder() / "scene.yaml";
  WriteText(path, text);
  return path.string();
}

std::map<std::string, std::string> FilesIn(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    files[entry.path().filename().string()] = ReadText(entry.path());
  }
  return files;
}

TEST(Simulate, WritesAUsersFilesAndTheTruthSeparately) {
  const fs::path out = TestFolder() / "session";
  const ProgramRun run = RunSextant("simulate " + SceneFile() + " --out " + out.string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const std::map<std::string, std::string> files = FilesIn(out);
  EXPECT_THAT(files,
              UnorderedElementsAre(Key("scene.yaml"), Key("simulation.yaml"), Key("boards.yaml"),
                                   Key("cam_info.yaml"), Key("scan_000.pcd"), Key("cam_000.png"),
                                   Key("truth.yaml")));
  const cv::Mat image = test::ReadPicture((out / "cam_000.png").string(), DecodedColor::kUnchanged);
  EXPECT_EQ(image.size(), cv::Size(160, 120));
  EXPECT_THAT(files.at("scan_000.pcd"), HasSubstr("FIELDS x y z intensity ring time\n"));
  EXPECT_THAT(files.at("truth.yaml"), HasSubstr("cam_from_lidar"));
  EXPECT_EQ(files.at("boards.yaml").find("cam_from_lidar"), std::string::npos);
}

TEST(Simulate, TheSameSeedGivesTheSameBytesAndAnotherOthers) {
  const std::string scene = SceneFile();
  const auto simulate = [&](const std::string& name, const std::string& options) {
    const fs::path out = TestFolder() / name;
    const ProgramRun run =
        RunSextant("simulate " + scene + " --scans 2 --out " + out.string() + " " + options);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return FilesIn(out);
  };
  const auto first = simulate("first", "--seed 4");
  EXPECT_EQ(first, simulate("second", "--seed 4"));
  const auto other = simulate("other", "--seed 5");
  EXPECT_NE(first.at("scan_001.pcd"), other.at("scan_001.pcd"));
  EXPECT_NE(first.at("cam_001.png"), other.at("cam_001.png"));
  EXPECT_NE(first.at("scan_000.pcd"), first.at("scan_001.pcd"));
}

TEST(Simulate, AKilledRunContinuesWhereItWas) {
  const std::string scene = SceneFile();
  const std::string whole = (TestFolder() / "whole").string();
  const std::string killed = (TestFolder() / "killed").string();
  const std::string command = std::string(SEXTANT_BINARY) + " simulate " + scene + " --scans 5";
  ASSERT_EQ(RunSextant("simulate " + scene + " --scans 5 --out " + whole).exit_code, 0);
  // Killed as soon as its second image exists.
  test::RunProgram("sh", "-c '" + command + " --out " + killed + " & pid=$!; while [ ! -e " +
                             killed +
                             "/cam_001.png ] && kill -0 $pid; do sleep 0.001; done; kill "
                             "-9 $pid; wait'");
  ASSERT_TRUE(fs::exists(killed + "/cam_001.png"));
  WriteText(killed + "/.scan_003.pcd.0123456789abcdef.sxtmp", "half");
  const fs::file_time_type before = fs::last_write_time(killed + "/cam_001.png");
  const ProgramRun resumed = RunSextant("simulate " + scene + " --scans 5 --out " + killed);
  ASSERT_EQ(resumed.exit_code, 0) << resumed.err;
  EXPECT_EQ(resumed.out.find("kept: 0;"), std::string::npos) << resumed.out;
  EXPECT_EQ(fs::last_write_time(killed + "/cam_001.png"), before);
  EXPECT_EQ(FilesIn(killed), FilesIn(whole));
}

TEST(Simulate, ASignalLeavesNoTemporary) {
  const fs::path out = TestFolder() / "session";
  for (const char* signal : {"INT", "TERM", "HUP"}) {
    // As soon as there is a scan. In the background a shell's process ignores SIGINT, unless it is
    // started with env.
    test::RunProgram(
        "{", fmt::format("mkdir {0}; env --default-signal=INT " SEXTANT_BINARY
                         " simulate {1} --scans 1000 --out {0} & pid=$!; while [ ! -e "
                         "{0}/scan_000.pcd ] && kill -0 $pid; do sleep 0.01; done; kill -{2} $pid; "
                         "wait; }}",
                         out.string(), SceneFile(), signal));
    for (const auto& [name, content] : FilesIn(out)) EXPECT_NE(name.front(), '.') << signal << name;
    EXPECT_TRUE(fs::exists(out / "scan_000.pcd"));
    EXPECT_FALSE(fs::exists(out / "truth.yaml")) << "it ended by itself";
    fs::remove_all(out);
  }
}

TEST(Simulate, FewerScansLeaveAConsistentFolder) {
  if (!test::KeepsMarks(TestFolder())) GTEST_SKIP() << "the file system keeps no attributes";
  const std::string scene = " " + SceneFile() + " --out ";
  ASSERT_EQ(RunSextant("simulate" + scene + TestPath("two") + " --scans 2").exit_code, 0);
  ASSERT_EQ(RunSextant("simulate" + scene + TestPath("used") + " --scans 4").exit_code, 0);
  WriteText(TestPath("used/notes.txt"), "mine");
  const ProgramRun fewer = RunSextant("simulate" + scene + TestPath("used") + " --scans 2");
  ASSERT_EQ(fewer.exit_code, 0) << fewer.err;
  EXPECT_THAT(fewer.out, HasSubstr("removed: 4 of more scans"));
  auto expected = FilesIn(TestPath("two"));
  expected["notes.txt"] = "mine";
  EXPECT_EQ(FilesIn(TestPath("used")), expected);
  // A file of somebody else under the name of a later scan is not removed, and nothing changes.
  WriteText(TestPath("used/scan_001.pcd"), "mine");
  const auto before = FilesIn(TestPath("used"));
  const ProgramRun refused = RunSextant("simulate" + scene + TestPath("used"));
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("it was changed since sextant wrote it"));
  EXPECT_EQ(FilesIn(TestPath("used")), before);
}

TEST(Simulate, MoreScansMayBeAddedButNothingElseChanged) {
  const std::string scene = SceneFile();
  const std::string out = (TestFolder() / "session").string();
  ASSERT_EQ(RunSextant("simulate " + scene + " --out " + out).exit_code, 0);
  const ProgramRun more = RunSextant("simulate " + scene + " --scans 2 --out " + out);
  EXPECT_EQ(more.exit_code, 0) << more.err;
  EXPECT_THAT(more.out, HasSubstr("files written: 2, kept: 2"));
  const ProgramRun seed = RunSextant("simulate " + scene + " --seed 9 --out " + out);
  EXPECT_EQ(seed.exit_code, 2);
  EXPECT_THAT(seed.err, HasSubstr("the folder holds another simulation"));
  const std::string other = (TestFolder() / "other").string();
  fs::create_directories(other);
  WriteText(other + "/notes.txt", "mine");
  const ProgramRun foreign = RunSextant("simulate " + scene + " --out " + other);
  EXPECT_EQ(foreign.exit_code, 2);
  EXPECT_THAT(foreign.err, HasSubstr("holds 'notes.txt'"));
  EXPECT_EQ(FilesIn(other).size(), 1U);
}

TEST(Simulate, TheFastLevelsWriteProblemFiles) {
  const std::string scene = SceneFile();
  for (const std::string level : {"corners", "pairs"}) {
    const std::string out = (TestFolder() / level).string();
    const ProgramRun run =
        RunSextant("simulate " + scene + " --scans 3 --level " + level + " --out " + out);
    ASSERT_EQ(run.exit_code, 0) << run.err;
    const std::string solver = level == "corners" ? "kabsch" : "'refine(epnp)'";
    const ProgramRun compared =
        RunSextant("compare " + out + "/" + level + "_cam.yaml --solvers " + solver);
    EXPECT_EQ(compared.exit_code, 0) << compared.err;
    EXPECT_THAT(compared.out, HasSubstr("error [mm]"));
    const std::string of_truth = "compare " + out + "/" + level + "_cam.yaml --solvers " + solver +
                                 " --truth " + out + "/truth.yaml";
    const ProgramRun with_truth = RunSextant(of_truth + ":cam");
    EXPECT_EQ(with_truth.exit_code, 0) << with_truth.err;
    EXPECT_THAT(with_truth.out, HasSubstr("error [mm]"));
    EXPECT_EQ(RunSextant(of_truth).exit_code, 0);
    test::ExpectRefused(RunSextant(of_truth + ":left"), "has no camera 'left'; there are: cam");
    const ProgramRun with_boards =
        RunSextant("compare " + out + "/" + level + "_cam.yaml --solvers " + solver + " --boards " +
                   out + "/boards.yaml");
    EXPECT_EQ(with_boards.exit_code, 0) << with_boards.err;
    const ProgramRun no_boards =
        RunSextant("compare " + out + "/" + level + "_cam.yaml --boards " + out + "/cam_info.yaml");
    EXPECT_EQ(no_boards.exit_code, 2);
    EXPECT_THAT(no_boards.err,
                HasSubstr("cam_info.yaml:1: expected boards, with the key 'boards', but "
                          "this is a file of a camera's intrinsics"));
  }
}

TEST(Simulate, BadScenesEndInOneLineBeforeAnythingIsWritten) {
  const auto refusal = [](const std::string& from, const std::string& to) {
    std::string text = kSceneToSimulate;
    const std::string scene = SceneFile(text.replace(text.find(from), from.size(), to));
    const std::string out = (TestFolder() / "session").string();
    const ProgramRun run = RunSextant("simulate " + scene + " --out " + out);
    EXPECT_EQ(run.exit_code, 2) << to;
    EXPECT_EQ(std::count(run.err.begin(), run.err.end(), '\n'), 1) << run.err;
    EXPECT_THAT(run.err, HasSubstr("scene.yaml"));
    EXPECT_FALSE(fs::exists(out)) << to;
    return run.err;
  };
  EXPECT_THAT(refusal("name: small", "nome: small"), HasSubstr("did you mean 'name'?"));
  EXPECT_THAT(refusal("width_px: 160", "width_px: 0"), HasSubstr("0 x 120 px"));
  EXPECT_THAT(refusal("[2, 0.4, 1]", "[-2, 0.4, 1]"), HasSubstr("no camera sees it"));
  EXPECT_THAT(refusal("id: 3", "id: 5000"), HasSubstr("out of range"));
  EXPECT_THAT(refusal("vlp16", "vlp17"), HasSubstr("did you mean 'vlp16'?"));
  EXPECT_THAT(refusal("top_right_m: 0.5", "top_right_m: -1"), HasSubstr("more than zero"));
  EXPECT_EQ(RunSextant("simulate").exit_code, 2);
  EXPECT_EQ(RunSextant("simulate /nowhere.yaml").exit_code, 2);
  EXPECT_EQ(RunSextant("simulate " + SceneFile() + " --level ful").exit_code, 2);
  EXPECT_EQ(RunSextant("simulate " + SceneFile() + " --scans 0").exit_code, 2);
}

TEST(Simulate, DrawsAContactSheet) {
  const std::string sheet = (TestFolder() / "sheet.png").string();
  const ProgramRun run = RunSextant("simulate " + SceneFile() + " --sheet " + sheet + " --out " +
                                    (TestFolder() / "session").string());
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const cv::Mat drawn = test::ReadPicture(sheet);
  EXPECT_EQ(drawn.size(), cv::Size(3 * 640, 480));
  // In the folder that is yet to be made, as shells complete its name.
  const std::string folder = (TestFolder() / "new").string();
  const ProgramRun within = RunSextant("simulate " + SceneFile() + " --level pairs --sheet " +
                                       folder + "/sheet.png --out " + folder + "/");
  EXPECT_EQ(within.exit_code, 0) << within.err;
  EXPECT_TRUE(fs::exists(fs::path(folder) / "sheet.png"));
}

}  // namespace
}  // namespace sextant
