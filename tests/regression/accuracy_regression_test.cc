// SPDX-License-Identifier: Apache-2.0
// Compares the accuracy of every registered solver on seeded scenes with recorded figures:
// golden/NAME.json holds those of golden/NAME.yaml. scripts/update-golden rewrites them with this
// test.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "eval/experiment/run/run_trials.h"
#include "io/output/output_file.h"
#include "io/text/text_file.h"
#include "regression/golden_figures.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

std::filesystem::path GoldenFolder() { return SourceRoot() / "tests" / "regression" / "golden"; }

// The figures of the experiment with the current solvers.
std::vector<GoldenFigure> RunGolden(const std::string& name) {
  const Expected<Experiment> experiment =
      ReadExperiment(GoldenFolder() / (name + ".yaml"), BuiltinKinds(), BuiltinSolvers());
  if (!experiment) {
    ADD_FAILURE() << experiment.error().message;
    return {};
  }
  const std::filesystem::path rows = TestFolder() / "rows";
  EXPECT_TRUE(RunTrials(*experiment, {.rows_path = rows}));
  const Expected<RowFileReader> reader = RowFileReader::Open(rows);
  const Expected<ReportData> data = ReportData::Compute(*experiment, *reader);
  EXPECT_TRUE(data);
  return CollectFigures(*experiment, *data);
}

std::vector<GoldenFigure> ReadGolden(const std::string& name) {
  const std::filesystem::path path = GoldenFolder() / (name + ".json");
  const Expected<std::string> text = ReadTextFile(path);
  if (!text) {
    ADD_FAILURE() << text.error().message;
    return {};
  }
  const Expected<std::vector<GoldenFigure>> golden = ParseGolden(*text, path.string());
  EXPECT_TRUE(golden) << golden.error().message;
  return golden.value_or(std::vector<GoldenFigure>());
}

class AccuracyRegression : public testing::TestWithParam<const char*> {};

TEST_P(AccuracyRegression, NoSolverIsWorseThanItWas) {
  const std::string name = GetParam();
  const std::vector<GoldenFigure> now = RunGolden(name);
  if (std::getenv("SEXTANT_UPDATE_GOLDEN") != nullptr) {
    ASSERT_TRUE(WriteFileAtomically(GoldenFolder() / (name + ".json"), FormatGolden(now)));
  }
  for (const std::string& line : CompareWithGolden(ReadGolden(name), now)) ADD_FAILURE() << line;
}

constexpr const char* kExperiments[] = {"accuracy", "board_views", "sessions"};
INSTANTIATE_TEST_SUITE_P(Golden, AccuracyRegression, testing::ValuesIn(kExperiments),
                         [](const auto& test) { return std::string(test.param); });

TEST(GoldenFigures, ContainEveryRegisteredSolver) {
  std::vector<GoldenFigure> golden;
  for (const char* name : kExperiments) {
    for (const GoldenFigure& figure : ReadGolden(name)) golden.push_back(figure);
  }
  const SolverRegistry registry = BuiltinSolvers();
  for (const SolverEntry& entry : registry.entries()) {
    if (entry.name == "mean_offset") continue;  // A baseline that ignores the rotation.
    const bool held = std::any_of(golden.begin(), golden.end(), [&entry](const GoldenFigure& f) {
      return f.subject == entry.name || f.subject.starts_with(entry.name + "(");
    });
    EXPECT_TRUE(held) << entry.name << " is not in the golden figures; run scripts/update-golden";
  }
}

// The comparison reports worse, new and missing figures.
TEST(GoldenFigures, ReportWhatBecameWorse) {
  const std::vector<GoldenFigure> golden = {
      {"20 pixels", "epnp", "median(rotation_deg)", 0.10, 0.09, 0.11},
      {"20 pixels", "epnp", "rate(fine)", 0.99, 0.97, 1.0},
      {"20 pixels", "p3p", "median(rotation_deg)", 0.20, 0.18, 0.22}};
  EXPECT_THAT(CompareWithGolden(golden, golden), testing::IsEmpty());
  std::vector<GoldenFigure> now = golden;
  now[0].value = 0.15;
  now[1].value = 0.95;
  now[2].subject = "p4p";
  EXPECT_THAT(
      CompareWithGolden(golden, now),
      testing::ElementsAre(
          "epnp, 20 pixels: median(rotation_deg) is 0.15, was 0.1 [0.09, 0.11]: 50.0 percent worse",
          "epnp, 20 pixels: rate(fine) is 0.95, was 0.99 [0.97, 1]: 4.0 percent worse",
          "p4p, 20 pixels: median(rotation_deg) is new; run scripts/update-golden",
          "p3p, 20 pixels: median(rotation_deg) is missing: the solver no longer returns a pose "
          "there"));
  now = golden;
  now[0].value = 0.05;
  EXPECT_THAT(CompareWithGolden(golden, now), testing::IsEmpty()) << "better is not worse";
}

TEST(GoldenFigures, RoundTripThroughTheirFile) {
  const std::vector<GoldenFigure> golden = {{"a \"b\"", "x(y)", "rate(fine)", 0.5, 0.25, 0.75}};
  const auto read = ParseGolden(FormatGolden(golden), "golden");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->front().condition, "a \"b\"");
  EXPECT_EQ(read->front().high, 0.75);
  EXPECT_FALSE(ParseGolden("[[1]]", "golden"));
}

}  // namespace
}  // namespace sextant::test
