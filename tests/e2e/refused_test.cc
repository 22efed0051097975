// SPDX-License-Identifier: Apache-2.0
// Numbers and paths that the program refuses, each with a message and exit code 2.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "e2e/run_sextant.h"
#include "support/bag_built.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant {
namespace {

using test::ProgramRun;
using test::RunSextant;
using test::TestFolder;
using test::TestPath;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

void ExpectRefused(const std::string& arguments, const std::string& option) {
  SCOPED_TRACE(arguments);
  const ProgramRun run = RunSextant(arguments);
  test::ExpectRefused(run, option);
  EXPECT_THAT(run.err, HasSubstr("expected"));
}

// That these options are numbers, and counts with a range. What is no number is tested once, in
// tests/cli/parse_test.cc.
TEST(Refused, NumbersThatAreNotFinite) {
  ExpectRefused("boards a.pcd --board b.yaml --edge-growth nan", "--edge-growth");
  ExpectRefused("boards a.pcd --board b.yaml --beam-aperture nan", "--beam-aperture");
  ExpectRefused("boards a.pcd --board b.yaml --beam-divergence nan", "--beam-divergence");
  ExpectRefused("boards a.pcd --board b.yaml --region 0 0 0 1 1 nan", "--region");
  ExpectRefused("calibrate session --tolerance nan", "--tolerance");
  ExpectRefused("bag a.bag --tolerance nan", "--tolerance");
  ExpectRefused("advise result.yaml --pixel-sigma nan", "--pixel-sigma");
  ExpectRefused("simulate s.yaml --interval nan", "--interval");
  ExpectRefused("simulate s.yaml --pixel-sigma nan", "--pixel-sigma");
  ExpectRefused("simulate pairs --depth-sigma nan", "--depth-sigma");
  ExpectRefused("project --image a --cloud b --result c --out d --point-size nan", "--point-size");
  ExpectRefused("print-board b.yaml --out b.png --dpi nan", "--dpi");
}

TEST(Refused, CountsOutOfRange) {
  for (const std::string text : {"-1", "1000000000"}) {
    ExpectRefused("simulate pairs --views " + text, "--views");
    ExpectRefused("simulate pairs --outliers " + text, "--outliers");
    ExpectRefused("simulate s.yaml --scans " + text, "--scans");
    ExpectRefused("advise result.yaml --count " + text, "--count");
    ExpectRefused("calibrate session --bootstrap " + text, "--bootstrap");
    ExpectRefused("run e.yaml --threads " + text, "--threads");
  }
  for (const char* command :
       {"run e.yaml", "simulate pairs", "simulate s.yaml", "calibrate session", "list extractors",
        "boards a.pcd --board b.yaml"}) {
    ExpectRefused(std::string(command) + " --seed -1", "--seed");
  }
  ExpectRefused("solve ''", "expected a text, got an empty one");
}

// An option that is given is never silently ignored.
TEST(Refused, OptionsThatWouldHaveNoEffect) {
  const auto expect = [](const std::string& arguments, const std::string& reason) {
    SCOPED_TRACE(arguments);
    test::ExpectRefused(RunSextant(arguments), reason);
  };
  const std::string pose_is = " --pose-is cam_from_lidar";
  expect("detect a.png --camera c.yaml",
         "--camera has no effect without --board: add --board, or leave --camera out");
  expect("compare a.yaml" + pose_is, "--pose-is has no effect without --truth");
  expect("calibrate session" + pose_is, "--pose-is has no effect without --initial");
  expect("mark --cloud a.pcd" + pose_is, "--pose-is has no effect without --cam-from-lidar");
  expect("list extractors --lidars vlp16", "--lidars is for the scans of --trials");
  expect("list detectors --trials 0 --seed 1", "--seed is for the tags of --trials");
  expect("list solvers kabsch --markdown", "excludes");
  expect("simulate pairs --outliers 0 --outlier-shift 1", "--outlier-shift is for --outliers");
  expect("run e.yaml --shard 1/2 --export-problems " + TestPath("problems"),
         "--shard is for a run, which --export-problems replaces");
  expect("boards a.pcd --board b.yaml --raw-edges --edge-growth 0.1", "excludes");
  expect("print-board --template fast_calib --dpi 150 --out " + TestPath("board.pdf"),
         "--dpi is for a .png");
  expect("export result.yaml --to kitti --lidar-frame top", "--lidar-frame has no effect: kitti");
  const std::string scene =
      (test::SourceRoot() / "experiments/scenes/paper_two_boards.yaml").string();
  expect("simulate " + scene + " --pixel-sigma 1", "--pixel-sigma is for the levels");
  expect("simulate " + scene + " --level pairs --ideal", "--ideal is for the level full");
}

TEST(Refused, OptionsOfARecordingForFiles) {
  for (const char* name : {"a_1.png", "a_1.pcd", "board.yaml", "camera.yaml"}) {
    WriteText(TestPath(name), "");
  }
  const std::string files = "calibrate --image " + TestPath("a_1.png") + " --cloud " +
                            TestPath("a_1.pcd") + " --board " + TestPath("board.yaml") +
                            " --camera " + TestPath("camera.yaml");
  test::ExpectRefused(RunSextant(files + " --tolerance 0.05"), "--tolerance is for a recording");
  test::ExpectRefused(RunSextant(files + " --image-topic /a"), "--image-topic is for a recording");
  test::ExpectRefused(RunSextant(files + " --camera-name left"),
                      "--camera-name is for the folder of a simulated session");
}

std::string ScaledPoints(const std::string& exponent) {
  std::string text = "4\n";
  for (int sensor = 0; sensor < 2; ++sensor) {
    for (const char* row : {"0 0 1", "1 0 1", "0 1 1", "1 1 1"}) {
      for (const char c : std::string(row)) {
        text += c == '1' ? "1e" + exponent : std::string(1, c);
      }
      text += "\n";
    }
  }
  return text;
}

TEST(Refused, CoordinatesThatAreNotMetres) {
  const std::string path = TestPath("points.txt");
  WriteText(path, ScaledPoints("0"));
  EXPECT_EQ(RunSextant("solve " + path).exit_code, 0);
  for (const char* exponent : {"-160", "-300", "-12", "10", "100", "300"}) {
    WriteText(path, ScaledPoints(exponent));
    for (const char* command : {"solve ", "compare "}) {
      const ProgramRun run = RunSextant(command + path);
      EXPECT_EQ(run.exit_code, 2) << exponent << run.out;
      EXPECT_THAT(run.err, AllOf(HasSubstr(path), HasSubstr("metres"))) << exponent;
      EXPECT_THAT(run.out, Not(HasSubstr("nan"))) << exponent;
    }
  }
}

TEST(Refused, ALoopOfLinksIsAMessage) {
  const std::string loop = TestPath("loop");
  std::filesystem::create_symlink(loop, loop);
  const std::string image = TestPath("a.png");
  WriteText(image, "");
  for (const std::string& arguments :
       {"advise " + loop, "calibrate " + loop, "bag " + loop, "solve " + loop, "detect " + loop,
        "boards " + loop + " --board " + loop, "print-board " + loop + " --out " + image,
        "simulate " + loop, "run " + loop, "average " + loop,
        "project --image " + loop + " --cloud " + loop + " --result " + loop + " --out " + image,
        "calibrate --image '" + loop + "/*.png' --cloud '" + loop + "/*.pcd' --board " + loop}) {
    const ProgramRun run = RunSextant(arguments);
    EXPECT_EQ(run.exit_code, 2) << arguments << run.out;
    EXPECT_THAT(run.err, HasSubstr("loop")) << arguments;
  }
  ExpectRefused("simulate pairs --out " + loop + " --views 0", "--views");
}

TEST(Refused, ARecordingThatIsCutIsReadAndSaid) {
  SKIP_WHERE_NOT_BUILT();
  const std::string bytes = test::ReadText(test::SourceRoot() / "tests/fuzz/corpus/rosbag1/none");
  const std::string path = TestPath("cut.bag");
  // The index follows the chunk with the messages.
  WriteText(path, bytes.substr(0, bytes.size() - 300));
  const ProgramRun run = RunSextant("bag " + path);
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("3 topics, 3 messages"), HasSubstr("warning: the file ends"),
                             HasSubstr("the 3 messages before it are read")));
  WriteText(path, bytes.substr(0, bytes.find("compression=")));
  EXPECT_THAT(RunSextant("bag " + path).err, HasSubstr("nothing can be recovered"));
}

}  // namespace
}  // namespace sextant
