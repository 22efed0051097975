// SPDX-License-Identifier: Apache-2.0
// Folders of results: two processes at once, and what `sextant merge` replaces.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "e2e/run_sextant.h"
#include "support/file_marks.h"

namespace sextant::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

std::string WriteStudy(const std::string& name, const std::string& more, int trials) {
  const std::string path = TestPath(name);
  WriteText(path, fmt::format("title: A study\nkind: random_scene\ntrials: {}\nquick_trials: 20\n"
                              "parameters: {{data: points}}\nsolvers: [kabsch]\n"
                              "grid: {{outliers: [0, 0.25]}}\nmetrics: [rotation_deg]\n"
                              "tables:\n  - {{title: E, columns: ['rms(rotation_deg)']}}\n{}",
                              trials, more));
  return path;
}

std::string RowsIn(const std::string& folder) {
  return ReadText(TestFolder() / folder / "rows.sxtrows");
}

ProgramRun RunShard(const std::string& study, const std::string& options) {
  return RunSextant("run " + study + " " + options + " --out " + TestPath("parts"));
}

TEST(ResultFolder, TheReportOfACopyIsReplacedUnlessItWasChanged) {
  if (!KeepsMarks(TestFolder())) GTEST_SKIP() << "the file system keeps no attributes";
  const std::string experiment = WriteStudy("experiment.yaml", "", 20);
  const std::string out = TestPath("out");
  ASSERT_EQ(RunSextant("run " + experiment + " --out " + out).exit_code, 0);
  // As in a clone of a repository: without marks and without rows.
  const std::string copy = TestPath("copy");
  fs::create_directories(copy);
  for (const char* name : {"report.md", "summary.json", "tables.tex"}) {
    WriteText(copy + "/" + name, ReadText(out + "/" + name));
  }
  const ProgramRun again = RunSextant("run " + experiment + " --out " + copy);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  const std::string other = WriteStudy("other.yaml", "", 20);
  EXPECT_EQ(RunSextant("run " + other + " --fresh --out " + copy).exit_code, 0) << "marked now";
  WriteText(copy + "/tables.tex", "mine");
  const ProgramRun changed = RunSextant("run " + other + " --out " + copy);
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_THAT(changed.err, HasSubstr("it was changed since sextant wrote it; --overwrite"));
}

TEST(ResultFolder, NoRowsOfAnEarlierRunStayBesideANewReport) {
  if (!KeepsMarks(TestFolder())) GTEST_SKIP() << "the file system keeps no attributes";
  const std::string run =
      "run " + WriteStudy("study.yaml", "", 200) + " --out " + TestPath("out") + " --fresh";
  const std::string csv = TestPath("out") + "/rows.csv";
  ASSERT_EQ(RunSextant(run).exit_code, 0);
  ASSERT_TRUE(fs::exists(csv));
  const ProgramRun without = RunSextant(run + " --trials 30 --no-csv");
  EXPECT_EQ(without.exit_code, 0) << without.err;
  EXPECT_FALSE(fs::exists(csv));
  EXPECT_THAT(without.err, HasSubstr("rows.csv of an earlier run was removed"));
  EXPECT_THAT(RunSextant(run + " --no-csv").err, Not(HasSubstr("rows.csv")));
  // What somebody else wrote is kept, and said not to be of this run.
  WriteText(csv, "mine");
  const ProgramRun foreign = RunSextant(run + " --no-csv");
  EXPECT_EQ(foreign.exit_code, 0) << foreign.err;
  EXPECT_THAT(foreign.err, HasSubstr("rows.csv is not of this run"));
  EXPECT_EQ(ReadText(csv), "mine");
}

TEST(ResultFolder, WhatAKilledExportLeftInItsFoldersIsRemoved) {
  const std::string command =
      "run " + WriteStudy("study.yaml", "", 2) + " --export-problems " + TestPath("problems");
  ASSERT_EQ(RunSextant(command).exit_code, 0);
  const fs::path left = TestFolder() / "problems/002/.1.yaml.0123456789abcdef.sxtmp";
  WriteText(left, "half");
  const ProgramRun again = RunSextant(command);
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_FALSE(fs::exists(left));
}

TEST(ResultFolder, ASecondProcessIsRefusedWithTheNumberOfTheFirst) {
  const std::string study = WriteStudy("long.yaml", "", 200'000'000);
  const std::string out = TestPath("out");
  const std::string small = WriteStudy("small.yaml", "", 100);
  ASSERT_EQ(RunShard(small, "--shard 1/1").exit_code, 0);
  const std::string run = SEXTANT_BINARY " run " + study + " --threads 1 --out " + out;
  // The two lines are what the second run and the merge say while the first runs.
  const ProgramRun both = RunProgram(
      "{", fmt::format("{0} & pid=$!; while [ ! -s {1}/rows.sxtrows ]; do sleep 0.01; done; "
                       "{0}; echo run $?; {2} merge {3} {4}/rows.sxtrows --out {1}; echo merge $?; "
                       "kill -9 $pid; wait; echo $pid; }}",
                       run, out, SEXTANT_BINARY, small, TestPath("parts")));
  EXPECT_THAT(both.out, HasSubstr("run 2\nmerge 2\n"));
  const std::size_t last_line = both.out.find_last_of('\n', both.out.size() - 2) + 1;
  const std::string pid = both.out.substr(last_line, both.out.size() - last_line - 1);
  EXPECT_THAT(both.err,
              HasSubstr("sextant run: the folder '" + out + "' is in use by process " + pid + ";"));
  EXPECT_THAT(both.err, HasSubstr("sextant merge: the folder '" + out + "' is in use by process " +
                                  pid + ";"));
  // The lock of a process that was killed keeps nobody out.
  EXPECT_EQ(RunSextant("run " + small + " --fresh --out " + out).exit_code, 0);
}

TEST(ResultFolder, MergeTakesTheOptionsOfRun) {
  const std::string study = WriteStudy("study.yaml", "", 1000);
  const std::string options = "--solvers 'kabsch,ransac(kabsch)' --seed 4 --trials 300";
  ASSERT_EQ(RunShard(study, options + " --shard 1/2").exit_code, 0);
  ASSERT_EQ(RunShard(study, options + " --shard 2/2").exit_code, 0);
  const std::string shards = TestPath("parts") + "/shard_*.sxtrows";
  const ProgramRun merged =
      RunSextant("merge " + study + " " + shards + " " + options + " --out " + TestPath("merged"));
  ASSERT_EQ(merged.exit_code, 0) << merged.err;
  ASSERT_EQ(RunSextant("run " + study + " " + options + " --out " + TestPath("whole")).exit_code,
            0);
  EXPECT_EQ(RowsIn("merged"), RowsIn("whole"));
  const ProgramRun wrong =
      RunSextant("merge " + study + " " + shards + " --out " + TestPath("wrong"));
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("rows of another configuration"));
}

TEST(ResultFolder, MergeReplacesTheRowsOfAnotherExperimentOnlyOnDemand) {
  const std::string other = WriteStudy("other.yaml", "seed: 5\n", 200);
  ASSERT_EQ(RunSextant("run " + other + " --out " + TestPath("out")).exit_code, 0);
  const std::string before = RowsIn("out");
  const std::string study = WriteStudy("study.yaml", "", 200);
  ASSERT_EQ(RunShard(study, "").exit_code, 0);
  const std::string rows = " " + TestPath("parts") + "/rows.sxtrows --out " + TestPath("out");
  const ProgramRun refused = RunSextant("merge " + study + rows);
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_THAT(refused.err, HasSubstr("it holds the rows of another experiment"));
  // The right rows with the wrong experiment.
  EXPECT_EQ(RunSextant("merge " + other + rows).exit_code, 2);
  EXPECT_EQ(RowsIn("out"), before);
  EXPECT_EQ(RunSextant("merge " + study + rows + " --overwrite").exit_code, 0);
  EXPECT_EQ(RowsIn("out"), RowsIn("parts"));
  // The same experiment again needs no question.
  EXPECT_EQ(RunSextant("merge " + study + rows).exit_code, 0);
}

TEST(ResultFolder, MergeDoesNotReadItsOwnTarget) {
  const std::string study = WriteStudy("study.yaml", "", 200);
  ASSERT_EQ(RunShard(study, "").exit_code, 0);
  const std::string before = RowsIn("parts");
  const ProgramRun merged = RunSextant("merge " + study + " " + TestPath("parts") +
                                       "/rows.sxtrows --out " + TestPath("parts"));
  EXPECT_EQ(merged.exit_code, 2);
  EXPECT_THAT(merged.err, HasSubstr("is itself one of the files to merge"));
  EXPECT_EQ(RowsIn("parts"), before);
}

TEST(ResultFolder, TheTrialsOfADamagedBlockRunAgain) {
  const std::string study = WriteStudy("study.yaml", "", 3000);
  ASSERT_EQ(RunShard(study, "").exit_code, 0);
  const std::string before = RowsIn("parts");
  std::string damaged = before;
  damaged[damaged.size() / 2] ^= 1;
  WriteText(TestFolder() / "parts" / "rows.sxtrows", damaged);
  const ProgramRun again = RunShard(study, "");
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_EQ(RowsIn("parts"), before);
}

TEST(ResultFolder, AForeignReportIsFoundBeforeTheTrials) {
  fs::create_directories(TestFolder() / "parts");
  WriteText(TestFolder() / "parts" / "report.md", "my thesis");
  const ProgramRun run = RunShard(WriteStudy("study.yaml", "", 200'000'000), "");
  EXPECT_EQ(run.exit_code, 2);
  EXPECT_THAT(run.err, HasSubstr("report.md': it exists, and sextant did not write it"));
  EXPECT_EQ(ReadText(TestFolder() / "parts" / "report.md"), "my thesis");
  EXPECT_FALSE(fs::exists(TestFolder() / "parts" / "rows.sxtrows"));
}

}  // namespace
}  // namespace sextant::test
