// SPDX-License-Identifier: Apache-2.0
// Solvers and poses of other programs, in the same tables as our own.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <string>

#include "e2e/run_sextant.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// The LiDAR's points are the camera's, moved by (-1, 0, 0).
const std::string kPairs =
    "camx,camy,camz,lidarx,lidary,lidarz\n1,0,3,0,0,3\n2,0,4,1,0,4\n1,1,5,0,1,5\n1,2,3,0,2,3\n";
const std::string kRight = R"({"translation_m": [1, 0, 0], "quaternion_wxyz": [1, 0, 0, 0]})";

std::string PairsFile() {
  WriteText(TestFolder() / "pairs.csv", kPairs);
  return TestPath("pairs.csv");
}

// The spec of a shell script with that content, for a shell.
std::string CommandOf(const std::string& script, const std::string& options = "") {
  WriteText(TestFolder() / "solver.sh", script);
  return "'command(\"sh " + TestPath("solver.sh") + "\"" + options + ")'";
}

ProgramRun SolveWith(const std::string& script, const std::string& options = "") {
  return RunSextant("solve " + PairsFile() + " --solver " + CommandOf(script, options));
}

TEST(External, ACommandGetsTheProblemAndItsAnswerIsEvaluated) {
  const std::string seen = TestPath("seen.yaml");
  const ProgramRun run = SolveWith("cat > " + seen + "\necho '" + kRight + "'\n");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("1.000000 0.000000 0.000000 m"), HasSubstr("0 mm over 4")));
  EXPECT_THAT(ReadText(seen), AllOf(HasSubstr("sextant_problem: 1"), HasSubstr("pairs_3d3d"),
                                    Not(HasSubstr("true_cam_from_lidar"))));
}

TEST(External, ACommandWorksInCombinatorsAndTables) {
  const std::string command = CommandOf("cat > /dev/null\necho '" + kRight + "'\n");
  const std::string list = command.substr(1, command.size() - 2);
  const ProgramRun run = RunSextant("compare " + PairsFile() + " --solvers 'kabsch," + list +
                                    ",drop_worst(" + list + ",keep=3)'");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("command(\"sh"), HasSubstr("drop_worst(command(")));
  EXPECT_THAT(run.out, Not(HasSubstr("no answer")));
}

TEST(External, WhatGoesWrongInACommandIsNamed) {
  const auto error = [](const std::string& script, const std::string& options = "") {
    const ProgramRun run = SolveWith(script, options);
    EXPECT_EQ(run.exit_code, 1) << script;
    return run.err;
  };
  EXPECT_THAT(error("echo starts >&2\necho 'no such module' >&2\nexit 3\n"),
              HasSubstr("sh: exit code 3: no such module"));
  EXPECT_THAT(error("kill -9 $$\n"), HasSubstr("exit code 137"));
  EXPECT_THAT(error("sleep 30\n", ",timeout_s=0.2"), HasSubstr("stopped after 0.2 s"));
  EXPECT_THAT(error("echo hello\n"), HasSubstr("expected JSON, got 'hello"));
  EXPECT_THAT(error("echo '{}'\n"), HasSubstr("expected 'translation_m'"));
  EXPECT_THAT(error("echo '{\"error\": \"too flat\"}'\n"), HasSubstr("sh: too flat"));
  EXPECT_THAT(error("echo '{\"translation_m\": [0,0,0], \"quaternion_wxyz\": [2,0,0,0]}'\n"),
              HasSubstr("does not have length 1"));
  const ProgramRun none =
      RunSextant("solve " + PairsFile() + " --solver 'command(\"no_such_program\")'");
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.err, HasSubstr("no_such_program: cannot be started"));
}

TEST(External, AFileRunsCommandsOnlyWithConsent) {
  const std::string touched = TestPath("touched");
  const std::string command =
      CommandOf("echo ran > " + touched + "\ncat > /dev/null\necho '" + kRight + "'\n");
  const std::string experiment = TestPath("external.yaml");
  WriteText(experiment,
            "title: external\nkind: random_scene\ntrials: 2\nquick_trials: 2\n"
            "parameters: {data: points}\nsolvers: [" +
                command + "]\ntables:\n  - {title: t, columns: [rate(answered)]}\n");
  const std::string run = "run " + experiment + " --out " + TestPath("out");
  const ProgramRun refused = RunSextant(run);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("only with --allow-commands"));
  EXPECT_THAT(ReadText(touched), testing::IsEmpty());
  const ProgramRun allowed = RunSextant(run + " --allow-commands");
  EXPECT_EQ(allowed.exit_code, 0) << allowed.err;
  EXPECT_THAT(allowed.out, HasSubstr("100.0 %"));
}

TEST(External, ImportedPosesAndATruthJoinTheComparison) {
  const std::string poses = TestPath("poses.csv");
  WriteText(poses, "solver,x,y,z,qw,qx,qy,qz\ntheirs,1.001,0,0,1,0,0,0\nfar off,5,0,0,1,0,0,0\n");
  const ProgramRun run = RunSextant("compare " + PairsFile() + " --solvers kabsch --import " +
                                    poses + " --truth 1 0 0 1 0 0 0");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, AllOf(HasSubstr("error [mm]"), HasSubstr("score")));
  const std::size_t ours = run.out.find("\nkabsch");
  const std::size_t theirs = run.out.find("\ntheirs");
  EXPECT_LT(ours, theirs);
  EXPECT_LT(theirs, run.out.find("\nfar off"));
  // What it took is not known.
  const std::string row = run.out.substr(theirs + 1, run.out.find('\n', theirs + 1) - theirs - 1);
  EXPECT_THAT(row, testing::EndsWith(" -"));
  WriteText(poses, "solver,x,y,z,qw,qx,qy,qz\ntheirs,1,0,0,3,0,0,0\n");
  const ProgramRun bad = RunSextant("compare " + PairsFile() + " --import " + poses);
  EXPECT_EQ(bad.exit_code, 2);
  EXPECT_THAT(bad.err, HasSubstr("poses.csv:2: expected a quaternion of length 1, got 3"));
  std::string many = "solver,x,y,z,qw,qx,qy,qz\n";
  for (int i = 0; i < 1001; ++i) many += "s" + std::to_string(i) + ",0,0,0,1,0,0,0\n";
  WriteText(poses, many);
  EXPECT_THAT(RunSextant("compare " + PairsFile() + " --import " + poses).err,
              HasSubstr("has 1001 poses, expected at most 1000 to compare"));
}

TEST(External, ATruthOfTheOtherDirectionIsNoted) {
  // The camera looks along the LiDAR's x axis.
  WriteText(TestFolder() / "forward.csv",
            "camx,camy,camz,lidarx,lidary,lidarz\n0,0,3,3,0,0\n1,0,4,4,-1,0\n0,1,5,5,0,-1\n"
            "1,2,3,3,-1,-2\n");
  const auto errors_with = [](const std::string& truth) {
    const ProgramRun run = RunSextant("compare " + TestPath("forward.csv") +
                                      " --solvers kabsch --truth 0 0 0 " + truth);
    EXPECT_EQ(run.exit_code, 0) << run.err;
    return run.err;
  };
  EXPECT_EQ(errors_with("0.5 0.5 -0.5 0.5"), "");
  EXPECT_EQ(errors_with("0.5 -0.5 0.5 -0.5 --pose-is lidar_from_cam"), "");
  EXPECT_THAT(errors_with("0.5 -0.5 0.5 -0.5"),
              AllOf(HasSubstr("read as cam_from_lidar, the camera is not upright"),
                    HasSubstr("the pose is 120 deg from the answer, but its inverse 0 deg; it "
                              "seems to be lidar_from_cam")));
  EXPECT_THAT(errors_with("0.5 0.5 -0.5 0.5 --pose-is lidar_from_cam"),
              HasSubstr("it seems to be cam_from_lidar (--pose-is cam_from_lidar)"));
}

TEST(External, APoseInQuotesIsRefusedWithBothForms) {
  ExpectRefused(
      RunSextant("compare " + PairsFile() + " --truth '1 0 0 1 0 0 0'"),
      "--truth: cannot read '1 0 0 1 0 0 0': No such file or directory; expected a file with a "
      "pose, or seven separate numbers X Y Z QW QX QY QZ, without quotes");
}

TEST(External, AnExperimentHasPosesThatWereFoundElsewhere) {
  const std::string experiment = TestPath("theirs.yaml");
  const auto write = [&](const std::string& solvers) {
    WriteText(experiment, "kind: random_scene\ntrials: 2\nquick_trials: 2\nsolvers: [" + solvers +
                              "]\nparameters: {data: points, pairs: 8}\n"
                              "grid: {outliers: [0], sigma_m: [0.01]}\n"
                              "tables:\n  - {title: t, columns: [rate(answered)]}\n");
  };
  write("kabsch");
  const std::string problems = TestPath("problems");
  const ProgramRun exported = RunSextant("run " + experiment + " --export-problems " + problems);
  EXPECT_EQ(exported.exit_code, 0) << exported.err;
  EXPECT_THAT(ReadText(problems + "/problems.csv"),
              HasSubstr("\"outliers=0, sigma_m=0.01\",1,001/1.yaml"));
  EXPECT_THAT(ReadText(problems + "/001/1.yaml"), HasSubstr("sextant_problem: 1"));
  // The pose of one of the two trials.
  WriteText(TestFolder() / "poses.csv",
            "solver,condition,trial,x,y,z,qw,qx,qy,qz\n"
            "theirs,\"outliers=0, sigma_m=0.01\",1,0,0,3,1,0,0,0\n");
  write("kabsch, 'imported(\"" + TestPath("poses.csv") + "\")'");
  const ProgramRun run = RunSextant("run " + experiment + " --out " + TestPath("out"));
  EXPECT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("50.0 %"));
  const ProgramRun alone = RunSextant("solve " + PairsFile() + " --solver 'imported(\"" +
                                      TestPath("poses.csv") + "\")'");
  EXPECT_EQ(alone.exit_code, 1);
  EXPECT_THAT(alone.err, HasSubstr("trials of an experiment only"));
}

TEST(External, LinesOfAComparisonFitATerminal) {
  const ProgramRun run = RunSextant("compare " + PairsFile());
  EXPECT_EQ(run.exit_code, 0) << run.err;
  std::size_t begin = 0;
  while (begin < run.out.size() && !run.out.substr(begin).starts_with("\nData diagnostics")) {
    const std::size_t end = run.out.find('\n', begin);
    EXPECT_LE(end - begin, 100U) << run.out.substr(begin, end - begin);
    begin = end + 1;
  }
}

}  // namespace
}  // namespace sextant::test
