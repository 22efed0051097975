// SPDX-License-Identifier: Apache-2.0
#include "bench/compare.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/run_program.h"

namespace sextant::bench {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Timing Timed(double median_ns, double spread) {
  return {.median_ns = median_ns, .spread = spread, .error = {}};
}

Change ChangeOf(const Timing& before, const Timing& after) {
  return CompareTimings({{"a", before}}, {{"a", after}}).front().change;
}

TEST(CompareTimings, IgnoresDifferencesWithinTheNoise) {
  // Three times sqrt(2) times 2 percent are 8.5.
  EXPECT_EQ(ChangeOf(Timed(100.0, 0.02), Timed(108.0, 0.02)), Change::kSame);
  EXPECT_EQ(ChangeOf(Timed(100.0, 0.02), Timed(109.0, 0.02)), Change::kSlower);
  EXPECT_EQ(ChangeOf(Timed(109.0, 0.02), Timed(100.0, 0.02)), Change::kFaster);
  EXPECT_EQ(ChangeOf(Timed(108.0, 0.02), Timed(100.0, 0.02)), Change::kSame);
  EXPECT_EQ(ChangeOf(Timed(100.0, 0.2), Timed(150.0, 0.0)), Change::kSame);
}

TEST(CompareTimings, DoesNotTrustAgreementOfFewRepetitions) {
  EXPECT_EQ(ChangeOf(Timed(100.0, 0.0), Timed(102.9, 0.0)), Change::kSame);
  EXPECT_EQ(ChangeOf(Timed(100.0, 0.0), Timed(103.1, 0.0)), Change::kSlower);
}

TEST(CompareTimings, WrongResultsAreRegressionsButMissingOnesAreNot) {
  const Timing wrong{.median_ns = {}, .spread = 0.0, .error = "wrong: 1 rad"};
  const auto now_wrong = CompareTimings({{"a", Timed(5.0, 0.01)}}, {{"a", wrong}});
  EXPECT_EQ(now_wrong.front().change, Change::kNowWrong);
  EXPECT_TRUE(HasRegression(now_wrong));
  const auto gone = CompareTimings({{"a", Timed(5.0, 0.01)}}, {{"b", Timed(5.0, 0.01)}});
  EXPECT_EQ(gone[0].change, Change::kGone);
  EXPECT_EQ(gone[1].change, Change::kNew);
  EXPECT_FALSE(HasRegression(gone));
  EXPECT_EQ(ChangeOf(wrong, wrong), Change::kSame);
  EXPECT_EQ(ChangeOf(wrong, Timed(5.0, 0.0)), Change::kNew);
}

TEST(CompareTimings, ListsTheWorstFirst) {
  const Timings before = {
      {"a", Timed(100.0, 0.0)}, {"b", Timed(100.0, 0.0)}, {"c", Timed(100.0, 0.0)}};
  const Timings after = {
      {"a", Timed(50.0, 0.0)}, {"b", Timed(110.0, 0.0)}, {"c", Timed(300.0, 0.0)}};
  std::vector<std::string> names;
  for (const Difference& difference : CompareTimings(before, after)) {
    names.push_back(difference.name);
  }
  EXPECT_THAT(names, ElementsAre("c", "b", "a"));
}

// Output of Google Benchmark for seven repetitions.
nlohmann::json MadeUpRun(double median_us, double spread) {
  const auto entry = [](const char* aggregate, double time) {
    return nlohmann::json{{"run_name", "kabsch/sextant/8"},
                          {"run_type", "aggregate"},
                          {"aggregate_name", aggregate},
                          {"cpu_time", time},
                          {"time_unit", "us"}};
  };
  return {{"context", nlohmann::json::object()},
          {"benchmarks",
           {{{"run_name", "kabsch/sextant/8"}, {"cpu_time", 99.0}, {"time_unit", "us"}},
            entry("median", median_us),
            entry("cv", spread),
            {{"run_name", "p3p/peer/3"}, {"error_occurred", true}, {"error_message", "wrong"}}}}};
}

void WriteRun(const std::filesystem::path& folder, double median_us, double spread) {
  std::filesystem::create_directories(folder);
  test::WriteText(folder / "bench_kernels.json", MadeUpRun(median_us, spread).dump());
}

TEST(ReadTimings, ReadsAFolder) {
  WriteRun(test::TestFolder() / "run", 1.5, 0.01);
  test::WriteText(test::TestFolder() / "run" / "flags.txt", "-O3\n");
  const Expected<Timings> timings = ReadTimings(test::TestFolder() / "run");
  ASSERT_TRUE(timings) << timings.error().message;
  EXPECT_EQ(timings->size(), 2U);
  EXPECT_DOUBLE_EQ(*timings->at("kabsch/sextant/8").median_ns, 1500.0);
  EXPECT_EQ(timings->at("kabsch/sextant/8").spread, 0.01);
  EXPECT_EQ(timings->at("p3p/peer/3").error, "wrong");
  EXPECT_FALSE(ReadTimings(test::TestFolder() / "nowhere"));
}

TEST(AddTimings, KeepsTheFastestRunOrAWrongOne) {
  Timings timings;
  for (const double median_us : {1.6, 1.5, 1.7}) AddTimings(MadeUpRun(median_us, 0.01), timings);
  EXPECT_DOUBLE_EQ(*timings.at("kabsch/sextant/8").median_ns, 1500.0);
  nlohmann::json wrong = MadeUpRun(1.0, 0.01);
  for (nlohmann::json& entry : wrong["benchmarks"]) entry["error_occurred"] = true;
  AddTimings(wrong, timings);
  AddTimings(MadeUpRun(1.0, 0.01), timings);
  EXPECT_FALSE(timings.at("kabsch/sextant/8").median_ns);
}

TEST(BenchCompare, ReturnsOneIfSomethingBecameSlower) {
  const std::filesystem::path folder = test::TestFolder();
  WriteRun(folder / "old", 1.5, 0.01);
  WriteRun(folder / "same", 1.53, 0.01);
  WriteRun(folder / "slow", 1.8, 0.01);
  const auto compare = [&](const char* before, const char* after) {
    return test::RunProgram(SEXTANT_BENCH_COMPARE,
                            (folder / before).string() + " " + (folder / after).string());
  };
  const test::ProgramRun same = compare("old", "same");
  EXPECT_EQ(same.exit_code, 0) << same.err;
  EXPECT_EQ(same.out, "2 of 2 within the noise\n");
  const test::ProgramRun slow = compare("old", "slow");
  EXPECT_EQ(slow.exit_code, 1);
  EXPECT_THAT(slow.out, HasSubstr("SLOWER"));
  EXPECT_THAT(slow.out, HasSubstr("1.200"));
  EXPECT_THAT(slow.out, HasSubstr("1 of 2 within the noise"));
  EXPECT_EQ(compare("slow", "old").exit_code, 0);
  const test::ProgramRun none = compare("old", "nowhere");
  EXPECT_EQ(none.exit_code, 2);
  EXPECT_THAT(none.err, HasSubstr("has no results"));
}

}  // namespace
}  // namespace sextant::bench
