// SPDX-License-Identifier: Apache-2.0
// What every command does with the files that it writes, and with standard output.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "e2e/run_sextant.h"
#include "support/file_marks.h"

namespace sextant::test {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// The commands of a shell, in which $SEXTANT is the program. With their own redirections.
ProgramRun Shell(const std::string& commands) {
  return RunProgram("SEXTANT=" SEXTANT_BINARY "; {", commands + "; }");
}

// A file of correspondences and an image, in the test's folder.
std::string MakeProblem() {
  const std::string path = TestPath("problem.yaml");
  const ProgramRun made = RunSextant("simulate pairs --seed 3 --out " + path);
  EXPECT_EQ(made.exit_code, 0) << made.err;
  return path;
}

std::vector<std::string> NamesIn(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

TEST(Outputs, AnOutputIsNoInput) {
  const std::string problem = MakeProblem();
  const std::string before = ReadText(problem);
  const std::string hard = TestPath("hard.yaml");
  const std::string soft = TestPath("soft.yaml");
  fs::create_hard_link(problem, hard);
  fs::create_symlink("problem.yaml", soft);
  for (const std::string option : {"", " --overwrite"}) {
    const std::string solve = "solve " + problem + option + " --json ";
    ExpectRefused(RunSextant(solve + problem), "an output of the same command");
    ExpectRefused(RunSextant(solve + hard), "an output of the same command");
    ExpectRefused(RunSextant(solve + soft), "it is a link to 'problem.yaml'");
    ExpectRefused(RunSextant("convert " + problem + " " + hard + option), "of the same command");
  }
  EXPECT_EQ(ReadText(problem), before);
  EXPECT_TRUE(fs::is_symlink(soft));
}

TEST(Outputs, TwoOutputsAreNotOneFile) {
  const std::string problem = MakeProblem();
  const std::string same = TestPath("same");
  const std::string session = " --image a.png --cloud a.pcd --board b.yaml --camera c.yaml";
  // Before any input is read: none of these exists.
  ExpectRefused(RunSextant("calibrate" + session + " --out " + same + " --json " + same),
                "it is already an output of the same command");
  ExpectRefused(RunSextant("calibrate" + session + " --out " + same + " --problem " +
                           TestFolder().string() + "/./same"),
                "it is already an output of the same command");
  ExpectRefused(
      RunSextant("compare " + problem + " --json " + same + ".svg --plot " + same + ".svg"),
      "it is already an output of the same command");
  EXPECT_THAT(NamesIn(TestFolder()), ElementsAre("problem.yaml", "stderr", "stdout"));
}

TEST(Outputs, ADictionaryOfTagsIsAnInput) {
  const std::string dictionary = TestPath("tags.yml");
  WriteText(dictionary,
            "%YAML:1.0\n---\nnmarkers: 1\nmarkersize: 4\nmaxCorrectionBits: 0\n"
            "marker_0: \"1010010110100101\"\n");
  const std::string before = ReadText(dictionary);
  ExpectRefused(RunSextant("detect none.png --overwrite --detector 'aruco(file=\"" + dictionary +
                           "\")' --json " + dictionary),
                "an output of the same command");
  EXPECT_EQ(ReadText(dictionary), before);
}

TEST(Outputs, TheHistoryOfChecksIsClaimedBeforeTheWork) {
  const std::string result = TestPath("result.yaml");
  const std::string before = "cam_from_lidar: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
  WriteText(result, before);
  const std::string check = "check " + result + " --image none.png --cloud none.pcd --history ";
  ExpectRefused(RunSextant(check + result), "an output of the same command");
  ExpectRefused(RunSextant(check + TestPath("same") + " --json " + TestPath("same")),
                "it is already an output of the same command");
  fs::create_symlink("result.yaml", TestPath("link"));
  ExpectRefused(RunSextant(check + TestPath("link")), "it is a link to 'result.yaml'");
  EXPECT_EQ(ReadText(result), before);
}

// Without --out the result of several sensors is rig.json, not result.yaml.
TEST(Outputs, TheResultOfARigIsClaimedByItsName) {
  WriteText(TestPath("a_1.pcd"), "no scan");
  WriteText(TestPath("b_1.pcd"), "no scan");
  WriteText(TestPath("session.yaml"),
            "sextant_session: 1\nboards: none.yaml\nsensors:\n  - {name: a, clouds: a_*.pcd}\n"
            "  - {name: b, clouds: b_*.pcd}\n");
  WriteText(TestPath("result.yaml"), "mine");
  const auto calibrate = [](const std::string& options) {
    return Shell("cd " + TestFolder().string() + "; $SEXTANT calibrate session.yaml" + options);
  };
  ExpectRefused(calibrate(" --json rig.json"), "--out: cannot write 'rig.json': it is already");
  ExpectRefused(calibrate(""), "none.yaml");
  WriteText(TestPath("rig.json"), "mine");
  ExpectRefused(calibrate(""), "rig.json': it exists, and sextant did not write it");
}

TEST(Outputs, AnEmptyPathIsRefused) {
  const std::string problem = MakeProblem();
  ExpectRefused(RunSextant("solve " + problem + " --json ''"), "--json: expected a path");
  ExpectRefused(RunSextant("solve " + problem + " --json="), "--json");
  ExpectRefused(RunSextant("bag none.bag --extract ''"), "--extract: expected a path");
  ExpectRefused(RunSextant("run none.yaml --out ''"), "--out: expected a path");
  ExpectRefused(RunSextant("simulate pairs --out ''"), "--out: expected a path");
  ExpectRefused(RunSextant("simulate pairs --out -"), "does not write to standard output");
}

TEST(Outputs, AForeignFileIsReplacedOnlyOnDemand) {
  const std::string problem = MakeProblem();
  const std::string out = TestPath("out.yaml");
  WriteText(out, "my notes\n");
  ExpectRefused(RunSextant("convert " + problem + " " + out), "--overwrite replaces it");
  EXPECT_EQ(ReadText(out), "my notes\n");
  ASSERT_EQ(RunSextant("convert " + problem + " " + out + " --overwrite").exit_code, 0);
  const std::string written = ReadText(out);
  EXPECT_THAT(written, HasSubstr("sextant_problem"));
  if (!KeepsMarks(TestFolder())) GTEST_SKIP() << "the file system keeps no attributes";
  EXPECT_EQ(RunSextant("convert " + problem + " " + out).exit_code, 0) << "a file of sextant's";
  WriteText(out, written + "# edited\n");
  ExpectRefused(RunSextant("convert " + problem + " " + out), "--overwrite replaces it");
}

TEST(Outputs, AReadOnlyFileIsKept) {
  const std::string problem = MakeProblem();
  const std::string out = TestPath("out.yaml");
  ASSERT_EQ(RunSextant("convert " + problem + " " + out).exit_code, 0);
  fs::permissions(out, fs::perms{0444});
  ExpectRefused(RunSextant("convert " + problem + " " + out + " --overwrite"), "it is read-only",
                4);
}

TEST(Outputs, OverlaysOfImagesOfOneNameAreRefusedBeforeTheWork) {
  fs::create_directories(TestFolder() / "a");
  fs::create_directories(TestFolder() / "b");
  for (const char* name : {"a/1.png", "b/1.png", "out-1.png"}) {
    WriteText(TestFolder() / name, "no image");
  }
  const std::string overlay = " --overwrite --overlay " + TestPath("out.png");
  ExpectRefused(RunSextant("detect " + TestPath("a/1.png") + " " + TestPath("b/1.png") + overlay),
                "it is already an output");
  ExpectRefused(RunSextant("detect " + TestPath("a/1.png") + " " + TestPath("out-1.png") + overlay),
                "it is also an output");
  EXPECT_EQ(ReadText(TestPath("out-1.png")), "no image");
}

TEST(Outputs, AFullDiskIsReportedWithItsExitCode) {
  const std::string problem = MakeProblem();
  ExpectRefused(RunSextant("solve " + problem + " --json /dev/full"), "No space left on device", 4);
  ExpectRefused(RunSextant("solve " + problem + " --json " + TestPath("absent/x.json")),
                "No such file or directory", 4);
  for (const std::string& arguments :
       {std::string("--version"), std::string("--help-all"), std::string("list solvers"),
        "solve " + problem, "solve " + problem + " --json -",
        "simulate pairs --out " + TestPath("again.yaml")}) {
    ExpectRefused(Shell("$SEXTANT " + arguments + " >/dev/full"),
                  "sextant: cannot write to standard output: No space left on device", 4);
  }
}

TEST(Outputs, FilesAreWrittenAlsoIfStandardOutputIsFull) {
  const std::string problem = MakeProblem();
  const std::string json = TestPath("x.json");
  ExpectRefused(Shell("$SEXTANT solve " + problem + " --json " + json + " >/dev/full"),
                "cannot write to standard output", 4);
  EXPECT_THAT(ReadText(json), HasSubstr("\"results\""));
}

TEST(Outputs, AClosedStandardOutputIsReportedIfItWasNeeded) {
  const std::string problem = MakeProblem();
  ExpectRefused(Shell("$SEXTANT solve " + problem + " >&-"), "cannot write to standard output", 4);
  // The next file that is opened does not become standard output.
  const std::string out = TestPath("out.yaml");
  const ProgramRun silent = Shell("$SEXTANT convert " + problem + " " + out + " <&- >&- 2>&-");
  EXPECT_EQ(silent.exit_code, 0);
  EXPECT_EQ(ReadText(out), ReadText(problem));
}

TEST(Outputs, AClosedStandardErrorChangesNothing) {
  EXPECT_EQ(Shell("$SEXTANT solve /nowhere 2>&-").exit_code, 2);
  EXPECT_EQ(Shell("$SEXTANT solve /nowhere 2>/dev/full").exit_code, 2);
  EXPECT_EQ(Shell("$SEXTANT solve " + MakeProblem() + " 2>&-").exit_code, 0);
}

TEST(Outputs, AClosedPipeEndsQuietly) {
  for (const char* ignoring : {"", "trap '' PIPE; "}) {
    const std::string code = TestPath("code");
    const ProgramRun run = Shell(
        fmt::format("{{ {}sleep 0.2; $SEXTANT list solvers --markdown; echo $? >{}; }} | true",
                    ignoring, code));
    EXPECT_THAT(run.err, IsEmpty());
    EXPECT_EQ(ReadText(code), "0\n");
  }
}

TEST(Outputs, NamesThatAreNoUtf8DoNotAbortIt) {
  const std::string problem = MakeProblem();
  const std::string name = TestPath("caf\xe9.yaml");
  fs::copy_file(problem, name);
  const ProgramRun solve = RunSextant("solve '" + name + "' --json -");
  EXPECT_EQ(solve.exit_code, 0) << solve.err;
}

TEST(Outputs, ALoopOfLinksIsAnError) {
  fs::create_symlink("loop", TestPath("loop"));
  ExpectRefused(RunSextant("advise " + TestPath("loop")), "symbolic links");
}

TEST(Outputs, AFileThatWasBeingReplacedSurvivesAKill) {
  const std::string problem = MakeProblem();
  const std::string out = TestPath("out.yaml");
  ASSERT_EQ(RunSextant("convert " + problem + " " + out).exit_code, 0);
  std::string before = ReadText(out);
  // Killed at many moments of a run that replaces the file.
  for (int ms = 0; ms < 60; ms += 3) {
    Shell(
        fmt::format("$SEXTANT simulate pairs --views 400 --seed {0} --out {1} & pid=$!; sleep "
                    "0.{0:03}; kill -9 $pid; wait",
                    ms, out));
    const std::string now = ReadText(out);
    EXPECT_TRUE(now == before || now.find("seed " + std::to_string(ms)) != std::string::npos) << ms;
    EXPECT_TRUE(now.ends_with("\n"));
    before = now;
  }
}

}  // namespace
}  // namespace sextant::test
