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
