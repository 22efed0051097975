// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/run/run_trials.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "eval/experiment/run/row_file.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

Experiment Small(const std::string& more = "") {
  return *ParseExperiment(
      "kind: random_scene\ntrials: 250\nsolvers: [kabsch, 'ransac(kabsch)']\n"
      "parameters: {data: points}\ngrid: {outliers: [0, 0.3]}\n" +
          more,
      "small.yaml", BuiltinKinds(), BuiltinSolvers());
}

std::string RunTo(const std::string& name, const Experiment& experiment, int threads,
                  Shard shard = {}) {
  const std::filesystem::path path = TestFolder() / name;
  const Expected<RunOutcome> outcome =
      RunTrials(experiment, {.rows_path = path, .threads = threads, .shard = shard});
  EXPECT_TRUE(outcome) << outcome.error().message;
  return ReadText(path);
}

TEST(RunTrials, SameBytesOnAnyNumberOfThreadsAndInTwoRuns) {
  const std::string one = RunTo("one", Small(), 1);
  EXPECT_GT(one.size(), 2U * 2 * 250 * 8 * PoseMetrics().size());
  EXPECT_TRUE(RunTo("two", Small(), 2) == one);
  EXPECT_TRUE(RunTo("again", Small(), 2) == one);
  EXPECT_TRUE(RunTo("five", Small(), 5) == one);
  EXPECT_FALSE(RunTo("seed", Small("seed: 2"), 2) == one);
}

TEST(RunTrials, ContinuesATruncatedFileToTheSameBytes) {
  const std::string whole = RunTo("whole", Small(), 2);
  for (std::size_t cut = 0; cut <= whole.size(); cut += whole.size() / 37 + 1) {
    WriteText(TestFolder() / "cut", whole.substr(0, cut));
    EXPECT_TRUE(RunTo("cut", Small(), 2) == whole) << "cut at byte " << cut;
  }
}

TEST(RunTrials, RunsNoTrialTwice) {
  RunTo("rows", Small(), 2);
  const std::filesystem::path path = TestFolder() / "rows";
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1);
  const Expected<RunOutcome> outcome = RunTrials(Small(), {.rows_path = path, .threads = 2});
  ASSERT_TRUE(outcome);
  EXPECT_EQ(outcome->kept_trials, 450U);
  EXPECT_EQ(outcome->run_trials, 50U);
}

// The offset of each block of a file.
std::vector<std::size_t> MarksIn(const std::string& bytes) {
  std::vector<std::size_t> marks;
  for (std::size_t at = bytes.find("sxtblock"); at != std::string::npos;
       at = bytes.find("sxtblock", at + 1)) {
    marks.push_back(at);
  }
  return marks;
}

TEST(RunTrials, RunsOnlyTheTrialsOfADamagedBlockAgain) {
  const std::string whole = RunTo("whole", Small(), 2);
  const std::vector<std::size_t> marks = MarksIn(whole);
  ASSERT_EQ(marks.size(), 6U);
  const std::filesystem::path path = TestFolder() / "damaged";
  // The mark, the number, the count of rows, a key, the checksum of the second block.
  for (const std::size_t at :
       {marks[1], marks[1] + 9, marks[1] + 17, marks[1] + 23, marks[1] + 24, marks[2] - 1}) {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    WriteText(path, damaged);
    const RowFileReader reader = *RowFileReader::Open(path);
    EXPECT_EQ(reader.blocks().size(), 5U) << at;
    EXPECT_FALSE(reader.is_orderly());
    ASSERT_EQ(reader.damage().size(), 1U);
    EXPECT_EQ(reader.damage()[0].offset, marks[1]);
    EXPECT_EQ(reader.damage()[0].bytes, marks[2] - marks[1]);
    const Expected<RunOutcome> outcome = RunTrials(Small(), {.rows_path = path, .threads = 2});
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_EQ(outcome->kept_trials, 400U);
    EXPECT_EQ(outcome->run_trials, 100U);
    ASSERT_EQ(outcome->damage.size(), 1U);
    EXPECT_THAT(outcome->damage[0], testing::HasSubstr("are damaged"));
    EXPECT_TRUE(ReadText(path) == whole) << at;
  }
}

// A kill while the lost block is computed leaves the file without it, or with it at the end.
TEST(RunTrials, RepairsAFileWithoutABlockAndOneInAnotherOrder) {
  const std::string whole = RunTo("whole", Small(), 2);
  const std::vector<std::size_t> marks = MarksIn(whole);
  const std::string second = whole.substr(marks[1], marks[2] - marks[1]);
  const std::string without = whole.substr(0, marks[1]) + whole.substr(marks[2]);
  for (const std::string& bytes : {without + second, without + second + second,
                                   whole.substr(0, marks[1]) + "x" + whole.substr(marks[1])}) {
    WriteText(TestFolder() / "rows", bytes);
    const Expected<RunOutcome> outcome =
        RunTrials(Small(), {.rows_path = TestFolder() / "rows", .threads = 1});
    ASSERT_TRUE(outcome) << outcome.error().message;
    EXPECT_EQ(outcome->run_trials, 0U);
    EXPECT_TRUE(ReadText(TestFolder() / "rows") == whole);
  }
}

TEST(RunTrials, MergeNamesTheDamage) {
  std::string damaged = RunTo("whole", Small(), 2);
  damaged[MarksIn(damaged)[1] + 30] ^= 1;
  WriteText(TestFolder() / "damaged", damaged);
  const Expected<void> merged =
      MergeRowFiles({TestFolder() / "damaged"}, TestFolder() / "merged", ConfigurationOf(Small()));
  ASSERT_FALSE(merged);
  EXPECT_THAT(merged.error().message, testing::HasSubstr("are damaged; 1 of 6 blocks"));
}

TEST(RunTrials, ShardsMergeToTheSameBytes) {
  const std::string whole = RunTo("whole", Small(), 2);
  std::vector<std::filesystem::path> shards;
  for (const std::uint64_t i : {2U, 0U, 1U}) {
    const std::string name = "shard" + std::to_string(i);
    RunTo(name, Small(), 2, {.number = i, .of = 3});
    shards.push_back(TestFolder() / name);
  }
  const Expected<void> merged =
      MergeRowFiles(shards, TestFolder() / "merged", ConfigurationOf(Small()));
  ASSERT_TRUE(merged) << merged.error().message;
  EXPECT_TRUE(ReadText(TestFolder() / "merged") == whole);
}

TEST(RunTrials, AFullRunDoesNotOverwriteAShard) {
  const std::string before = RunTo("rows", Small(), 2);
  EXPECT_FALSE(
      MergeRowFiles({TestFolder() / "rows"}, TestFolder() / "rows", ConfigurationOf(Small())));
  EXPECT_TRUE(ReadText(TestFolder() / "rows") == before);
}

TEST(RunTrials, MergeReplacesNoRowsOfAnotherConfiguration) {
  const std::string other = RunTo("merged", Small("seed: 2"), 2);
  RunTo("rows", Small(), 2);
  const Expected<void> wrong_rows = MergeRowFiles({TestFolder() / "rows"}, TestFolder() / "new",
                                                  ConfigurationOf(Small("seed: 2")));
  ASSERT_FALSE(wrong_rows);
  EXPECT_THAT(wrong_rows.error().message, testing::HasSubstr("rows of another configuration"));
  EXPECT_FALSE(std::filesystem::exists(TestFolder() / "new"));
  const Expected<void> wrong_target =
      MergeRowFiles({TestFolder() / "rows"}, TestFolder() / "merged", ConfigurationOf(Small()));
  ASSERT_FALSE(wrong_target);
  EXPECT_THAT(wrong_target.error().message, testing::HasSubstr("it holds the rows of another"));
  EXPECT_TRUE(ReadText(TestFolder() / "merged") == other);
}

TEST(RunTrials, FreshRowsReplaceNoFileOfAnotherKind) {
  WriteText(TestFolder() / "rows", "my notes\n");
  const Expected<RunOutcome> outcome =
      RunTrials(Small(), {.rows_path = TestFolder() / "rows", .fresh = true});
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, testing::HasSubstr("is not a row file"));
  EXPECT_EQ(ReadText(TestFolder() / "rows"), "my notes\n");
}

TEST(RunTrials, MergeReportsMissingBlocks) {
  RunTo("shard0", Small(), 2, {.number = 0, .of = 3});
  const Expected<void> merged =
      MergeRowFiles({TestFolder() / "shard0"}, TestFolder() / "merged", ConfigurationOf(Small()));
  ASSERT_FALSE(merged);
  EXPECT_THAT(merged.error().message,
              testing::HasSubstr("4 of 6 blocks are in none of the files, the first is number 1"));
}

TEST(RunTrials, DoesNotModifyRowsOfAnotherConfiguration) {
  const std::string before = RunTo("rows", Small(), 2);
  const std::filesystem::path path = TestFolder() / "rows";
  const Expected<RunOutcome> other = RunTrials(Small("seed: 2"), {.rows_path = path});
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, testing::HasSubstr("another configuration"));
  EXPECT_TRUE(ReadText(path) == before);
  EXPECT_TRUE(RunTrials(Small("seed: 2"), {.rows_path = path, .fresh = true}));
  EXPECT_FALSE(ReadText(path) == before);
}

TEST(RunTrials, DoesNotModifyOtherFiles) {
  WriteText(TestFolder() / "letter", "Dear reader, this is a file that somebody wants to keep.");
  const Expected<RunOutcome> outcome = RunTrials(Small(), {.rows_path = TestFolder() / "letter"});
  ASSERT_FALSE(outcome);
  EXPECT_THAT(outcome.error().message, testing::HasSubstr("not a row file of an experiment"));
  EXPECT_THAT(ReadText(TestFolder() / "letter"), testing::StartsWith("Dear reader"));
}

TEST(RunTrials, TrialsOfAConditionDoNotDependOnOtherConditions) {
  const auto rotations = [](const Experiment& experiment, std::size_t block) {
    const std::filesystem::path path = TestFolder() / "rows";
    EXPECT_TRUE(RunTrials(experiment, {.rows_path = path, .fresh = true}));
    const RowFileReader reader = *RowFileReader::Open(path);
    return *reader.ReadColumn(reader.blocks()[block], kRotationDeg);
  };
  const std::string head =
      "kind: random_scene\ntrials: 20\nsolvers: [kabsch]\nparameters: {data: points}\n";
  const auto parse = [&head](const std::string& conditions) {
    return *ParseExperiment(head + conditions, "a.yaml", BuiltinKinds(), BuiltinSolvers());
  };
  const auto alone = rotations(parse("conditions: [{name: b, pairs: 9}]"), 0);
  const auto second = rotations(parse("conditions: [{name: a}, {name: b, pairs: 9}]"), 1);
  EXPECT_EQ(alone, second);
}

}  // namespace
}  // namespace sextant::test
