// SPDX-License-Identifier: Apache-2.0
// `sextant run` and `sextant merge` as users run them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "e2e/run_sextant.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

std::string Quoted(const std::filesystem::path& path) { return "'" + path.string() + "'"; }

// Writes a small experiment with every kind of output; returns its path.
std::filesystem::path WriteExperiment(int trials) {
  std::filesystem::path path = TestFolder() / "small.yaml";
  WriteText(path,
            "title: A small one\nkind: random_scene\ntrials: " + std::to_string(trials) +
                "\nquick_trials: 20\nparameters: {data: points}\n"
                "solvers: [kabsch, 'ransac(kabsch, seed=3)']\ngrid: {outliers: [0, 0.25]}\n"
                "metrics: [rotation_deg, nees]\n"
                "tables:\n"
                "  - {title: Errors, columns: ['rms(rotation_deg, where=fine)', "
                "'efficiency(rotation_deg, bound_rotation_deg)']}\n"
                "  - {title: Success, columns: [rate(success)], across: outliers}\n"
                "plots:\n  - {name: growth, x: outliers, y: median(rotation_deg), log_y: true}\n");
  return path;
}

std::string RunArguments(const std::filesystem::path& experiment, const std::string& out,
                         const std::string& more = "") {
  return "run " + Quoted(experiment) + " --out " + Quoted(TestFolder() / out) + " " + more;
}

std::string Rows(const std::string& out) { return ReadText(TestFolder() / out / "rows.sxtrows"); }

TEST(Run, WritesRowsTablesAndPlots) {
  const ProgramRun run = RunSextant(RunArguments(WriteExperiment(200), "out"));
  ASSERT_EQ(run.exit_code, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("rms(rotation_deg,where=fine)"));
  EXPECT_THAT(run.out, HasSubstr("ransac(kabsch,seed=3)"));
  const std::filesystem::path out = TestFolder() / "out";
  const std::string csv = ReadText(out / "rows.csv");
  EXPECT_THAT(csv, testing::StartsWith(
                       "experiment,condition,outliers,subject,trial,index,fine,success,"
                       "rotation_deg,bound_rotation_deg,nees\nsmall,outliers=0,0,kabsch,0,0,1,"));
  EXPECT_THAT(csv, HasSubstr("small,outliers=0.25,0.25,\"ransac(kabsch,seed=3)\",199,0,"));
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + 2 * 2 * 200);
  const auto json = nlohmann::json::parse(ReadText(out / "summary.json"));
  const auto& cell = json["conditions"][0]["cells"][0];
  EXPECT_EQ(cell["metrics"]["nees"]["count"], 200);
  EXPECT_NEAR(cell["metrics"]["nees"]["mean"].get<double>(), 6.0, 5.0 * std::sqrt(12.0 / 200.0));
  EXPECT_NEAR(cell["figures"]["efficiency(rotation_deg,bound_rotation_deg)"]["value"], 1.0, 0.2);
  EXPECT_THAT(ReadText(out / "report.md"), HasSubstr("# A small one"));
  EXPECT_THAT(ReadText(out / "report.md"), HasSubstr("![growth](growth.svg)"));
  EXPECT_THAT(ReadText(out / "tables.tex"), HasSubstr("\\toprule"));
  EXPECT_THAT(ReadText(out / "tables.tex"), HasSubstr("rms(rotation\\_deg,where=fine)"));
  EXPECT_THAT(ReadText(out / "growth.svg"), HasSubstr("<svg"));
  EXPECT_THAT(ReadText(out / "growth.png"), HasSubstr("PNG"));
}

TEST(Run, SameBytesOnOneAndTwoThreads) {
  const std::filesystem::path experiment = WriteExperiment(150);
  ASSERT_EQ(RunSextant(RunArguments(experiment, "one", "--threads 1")).exit_code, 0);
  ASSERT_EQ(RunSextant(RunArguments(experiment, "two", "--threads 2")).exit_code, 0);
  for (const char* name :
       {"rows.sxtrows", "rows.csv", "summary.json", "report.md", "tables.tex", "growth.svg"}) {
    EXPECT_TRUE(ReadText(TestFolder() / "one" / name) == ReadText(TestFolder() / "two" / name))
        << name;
  }
}

TEST(Run, ContinuesAfterBeingKilledAtAnyMoment) {
  const std::filesystem::path experiment = WriteExperiment(2500);
  ASSERT_EQ(RunSextant(RunArguments(experiment, "whole", "--no-csv")).exit_code, 0);
  for (const char* seconds : {"0.05", "0.1", "0.15", "0.2"}) {
    RunProgram("timeout -s KILL " + std::string(seconds) + " " + SEXTANT_BINARY,
               RunArguments(experiment, "killed", "--no-csv"));
  }
  const ProgramRun last = RunSextant(RunArguments(experiment, "killed", "--no-csv"));
  ASSERT_EQ(last.exit_code, 0) << last.err;
  EXPECT_TRUE(Rows("killed") == Rows("whole"));
}

// A limit of the file size simulates a full disk.
TEST(Run, AFullDiskLosesNothing) {
  const std::filesystem::path experiment = WriteExperiment(2000);
  ASSERT_EQ(RunSextant(RunArguments(experiment, "whole", "--no-csv")).exit_code, 0);
  const ProgramRun full = RunProgram("trap '' XFSZ; ulimit -f 64; " SEXTANT_BINARY,
                                     RunArguments(experiment, "full", "--no-csv"));
  EXPECT_EQ(full.exit_code, 4);
  EXPECT_THAT(
      full.err,
      HasSubstr("what was written so far is kept: free some space and run the same command"));
  const std::string kept = Rows("full");
  EXPECT_GT(kept.size(), 9000U) << "at least one block";
  EXPECT_LE(kept.size(), 64U * 1024);
  const ProgramRun again = RunSextant(RunArguments(experiment, "full", "--no-csv"));
  EXPECT_THAT(again.err, HasSubstr("of 4000 trials were already in"));
  EXPECT_TRUE(Rows("full") == Rows("whole"));
}

TEST(Run, FoldersThatCannotBeWrittenAreNamed) {
  const std::filesystem::path experiment = WriteExperiment(10);
  WriteText(TestFolder() / "file", "not a folder");
  const ProgramRun in_file = RunSextant(RunArguments(experiment, "file/out"));
  EXPECT_EQ(in_file.exit_code, 4);
  EXPECT_THAT(in_file.err, HasSubstr("cannot make the folder"));
  const ProgramRun denied = RunSextant("run " + Quoted(experiment) + " --out /proc/sextant");
  EXPECT_EQ(denied.exit_code, 4);
  EXPECT_THAT(denied.err, HasSubstr("cannot make the folder '/proc/sextant'"));
}

TEST(Run, BadFilesAreRefusedBeforeAnythingIsWritten) {
  const std::filesystem::path path = TestFolder() / "bad.yaml";
  WriteText(path, "kind: random_scene\ntrials: 10\nsolvers: [kabsh]\n");
  const ProgramRun run = RunSextant(RunArguments(path, "out"));
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("bad.yaml:3: solvers: unknown solver 'kabsh'; did you mean"));
  EXPECT_FALSE(std::filesystem::exists(TestFolder() / "out"));
  EXPECT_THAT(RunSextant("run '/nowhere/x.yaml'").err, HasSubstr("cannot read"));
  EXPECT_THAT(RunSextant(RunArguments(WriteExperiment(10), "out", "--shard 3/2")).err,
              HasSubstr("expected I/N with 1 <= I <= N"));
}

TEST(Run, FinishedRowsAreNotRunAgainUnlessAsked) {
  const std::filesystem::path experiment = WriteExperiment(100);
  ASSERT_EQ(RunSextant(RunArguments(experiment, "out")).exit_code, 0);
  EXPECT_THAT(RunSextant(RunArguments(experiment, "out")).err,
              HasSubstr("200 of 200 trials were already in"));
  EXPECT_EQ(RunSextant(RunArguments(experiment, "out", "--fresh")).err, "");
  const ProgramRun other = RunSextant(RunArguments(experiment, "out", "--seed 5"));
  EXPECT_EQ(other.exit_code, 2);
  EXPECT_THAT(other.err, HasSubstr("start over with --fresh, or choose another folder"));
}

TEST(Merge, OfShardsIsTheWhole) {
  const std::filesystem::path experiment = WriteExperiment(300);
  ASSERT_EQ(RunSextant(RunArguments(experiment, "whole")).exit_code, 0);
  for (const char* shard : {"1/3", "2/3", "3/3"}) {
    ASSERT_EQ(
        RunSextant(RunArguments(experiment, "parts", std::string("--shard ") + shard)).exit_code,
        0);
  }
  const ProgramRun merge =
      RunSextant("merge " + Quoted(experiment) + " " + (TestFolder() / "parts").string() +
                 "/shard_*.sxtrows --out " + Quoted(TestFolder() / "merged"));
  ASSERT_EQ(merge.exit_code, 0) << merge.err;
  EXPECT_TRUE(Rows("merged") == Rows("whole"));
  EXPECT_EQ(ReadText(TestFolder() / "merged" / "summary.json"),
            ReadText(TestFolder() / "whole" / "summary.json"));
}

TEST(Kinds, AreListed) {
  const ProgramRun run = RunSextant("list kinds");
  EXPECT_EQ(run.exit_code, 0);
  EXPECT_THAT(run.out, HasSubstr("### random_scene"));
  EXPECT_THAT(run.out, HasSubstr("| `sigma_px` | 1 | px | noise of pixels, per axis |"));
}

}  // namespace
}  // namespace sextant::test
