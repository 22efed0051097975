// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "eval/experiment/definition/experiment.h"
#include "solvers/builtin_solvers.h"
#include "solvers/opencv/opencv_solvers.h"
#include "support/bad_text.h"
#include "support/real_data.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

Expected<Experiment> Parse(const std::string& text) {
  return ParseExperiment(text, "try.yaml", BuiltinKinds(), BuiltinSolvers());
}

constexpr const char* kWhole = R"(title: Points
kind: random_scene
seed: 7
trials: 300
quick_trials: 30
parameters: {data: points, sigma_m: 0.02}
solvers: [kabsch, refine(kabsch)]
conditions:
  - {name: few, pairs: 6}
  - {name: many, pairs: 20, solvers: [kabsch]}
grid: {outliers: [0, 0.1, 0.2]}
metrics: [rotation_deg]
tables:
  - {title: Errors, columns: [rms(rotation_deg), 'p95(rotation_deg, where=fine)'], labels: [a, b]}
  - {columns: [rate(success)], across: outliers}
plots:
  - {name: growth, x: outliers, y: median(translation_mm), log_y: true}
)";

TEST(ExperimentFile, CombinesConditionsAndGrid) {
  const Expected<Experiment> experiment = Parse(kWhole);
  ASSERT_TRUE(experiment) << experiment.error().message;
  EXPECT_EQ(experiment->name, "try");
  EXPECT_EQ(experiment->seed, 7U);
  EXPECT_EQ(experiment->trials, 300U);
  EXPECT_EQ(experiment->quick_trials, 30U);
  ASSERT_EQ(experiment->conditions.size(), 6U);
  EXPECT_EQ(experiment->conditions[1].name, "few, outliers=0.1");
  EXPECT_THAT(experiment->conditions[1].place, testing::ElementsAre("0.1"));
  EXPECT_THAT(experiment->conditions[1].trials->subjects(),
              testing::ElementsAre("kabsch", "refine(kabsch)"));
  EXPECT_THAT(experiment->conditions[5].trials->subjects(), testing::ElementsAre("kabsch"));
  EXPECT_EQ(experiment->tables[0].columns[1].label, "b");
  EXPECT_EQ(experiment->tables[1].across, "outliers");
}

TEST(ExperimentFile, MeasuresRequestedMetricsAndThoseOfTheReport) {
  const Expected<Experiment> experiment = Parse(kWhole);
  ASSERT_TRUE(experiment);
  std::vector<std::string> wanted;
  for (std::size_t i = 0; i < experiment->metrics.size(); ++i) {
    if (experiment->wanted[i]) wanted.push_back(experiment->metrics[i].name);
  }
  EXPECT_THAT(wanted,
              testing::UnorderedElementsAre("fine", "success", "rotation_deg", "translation_mm"));
}

TEST(ExperimentFile, LeavesOutSolversWithoutSuitableData) {
  const Expected<Experiment> experiment = Parse(
      "{kind: random_scene, trials: 1, solvers: [kabsch, epnp], conditions: [{name: a, data: "
      "points}, {name: b, data: pixels}]}");
  ASSERT_TRUE(experiment) << experiment.error().message;
  EXPECT_THAT(experiment->conditions[0].trials->subjects(), testing::ElementsAre("kabsch"));
  EXPECT_THAT(experiment->conditions[1].trials->subjects(), testing::ElementsAre("epnp"));
}

TEST(ExperimentFile, AllExpandsToEverySuitableSolver) {
  const Expected<Experiment> experiment =
      Parse("{kind: random_scene, trials: 1, solvers: [all, icp], parameters: {data: points}}");
  ASSERT_TRUE(experiment) << experiment.error().message;
  const std::vector<std::string>& subjects = experiment->conditions[0].trials->subjects();
  EXPECT_THAT(subjects, testing::IsSupersetOf({"kabsch", "ransac(kabsch)", "gnc(kabsch)", "icp"}));
  EXPECT_THAT(subjects, testing::Not(testing::Contains("epnp")));
  EXPECT_THAT(subjects, testing::Not(testing::Contains("mean_offset")));
}

TEST(ExperimentFile, CommandLineSolversReplaceThoseOfTheFile) {
  const std::string text =
      "{kind: random_scene, trials: 1, solvers: [kabsch], conditions: [{name: a, data: points}, "
      "{name: b, data: pixels, solvers: [p3p]}]}";
  const Expected<Experiment> experiment = ParseExperiment(
      text, "try.yaml", BuiltinKinds(), BuiltinSolvers(), "epnp,ransac(p3p,seed=2)");
  ASSERT_TRUE(experiment) << experiment.error().message;
  ASSERT_EQ(experiment->conditions.size(), 1U) << "the solvers cannot use points";
  EXPECT_THAT(experiment->conditions[0].trials->subjects(),
              testing::ElementsAre("epnp", "ransac(p3p,seed=2)"));
  EXPECT_FALSE(ParseExperiment(text, "try.yaml", BuiltinKinds(), BuiltinSolvers(), "epnq"));
  EXPECT_FALSE(ParseExperiment(text, "try.yaml", BuiltinKinds(), BuiltinSolvers(), "epnp("));
}

std::string With(const std::string& line) {
  return "kind: random_scene\ntrials: 10\nsolvers: [kabsch]\n" + line + "\n";
}

class BadExperiment : public testing::TestWithParam<BadText> {};

TEST_P(BadExperiment, IsRefused) { ExpectRefused(Parse(GetParam().text), GetParam()); }

INSTANTIATE_TEST_SUITE_P(
    Files, BadExperiment,
    testing::Values(
        BadText{"unknown_key", With("trails: 3"), ErrorCode::kParse,
                "try.yaml:4: experiment: unknown key 'trails'; did you mean 'trials'?"},
        BadText{"unknown_kind", "kind: random_scenes\ntrials: 1\n", ErrorCode::kParse,
                "try.yaml:1: kind: unknown kind 'random_scenes'; did you mean 'random_scene'?"},
        BadText{"no_trials", "kind: random_scene\nsolvers: [kabsch]\n", ErrorCode::kParse,
                "trials: expected this key"},
        BadText{"zero_trials", "kind: random_scene\ntrials: 0\nsolvers: [kabsch]\n",
                ErrorCode::kParse, "try.yaml:2: trials: expected a whole number from 1 to"},
        BadText{"unknown_solver", "kind: random_scene\ntrials: 1\nsolvers: [kabash]\n",
                ErrorCode::kParse, "try.yaml:3: solvers: unknown solver 'kabash'"},
        BadText{"unknown_option",
                "kind: random_scene\ntrials: 1\nsolvers: ['ransac(p3p, sed=1)']\n",
                ErrorCode::kParse, "has no option 'sed'; did you mean 'seed'?"},
        BadText{"solver_twice", "kind: random_scene\ntrials: 1\nsolvers: [kabsch, kabsch]\n",
                ErrorCode::kParse, "'kabsch' is listed twice"},
        BadText{"no_solvers", "kind: random_scene\ntrials: 1\n", ErrorCode::kParse,
                "expected solvers, a list with at least one entry"},
        BadText{"unknown_parameter", With("parameters: {pair: 8}"), ErrorCode::kParse,
                "try.yaml:4: parameters: unknown key 'pair'; did you mean 'pairs'?"},
        BadText{"parameter_range", With("parameters: {sigma_m: -1}"), ErrorCode::kInvalidOption,
                "option sigma_m=-1: expected a number from"},
        BadText{"impossible_geometry", With("parameters: {depth_m: 1.0, extent_m: 1.0}"),
                ErrorCode::kInvalidOption, "puts points behind the camera"},
        BadText{"condition_twice", With("conditions: [{name: a}, {name: a}]"), ErrorCode::kParse,
                "a: a second condition has this name"},
        BadText{"unnamed_condition", With("conditions: [{pairs: 8}]"), ErrorCode::kParse,
                "name: expected this key"},
        BadText{"empty_axis", With("grid: {pairs: []}"), ErrorCode::kParse,
                "expected 1 to 10000 conditions in all, got 0"},
        BadText{"no_fitting_solver", With("parameters: {data: pixels}"), ErrorCode::kMissingData,
                "none of the solvers can use this condition's data; kabsch needs 3D-3D"},
        BadText{"unknown_metric", With("metrics: [rotation_rad]"), ErrorCode::kParse,
                "unknown metric 'rotation_rad'; did you mean 'rotation_deg'?"},
        BadText{"unknown_statistic", With("tables: [{columns: [avg(nees)]}]"), ErrorCode::kParse,
                "statistic 'avg(nees)': unknown statistic 'avg'"},
        BadText{"one_metric", With("tables: [{columns: [efficiency(nees)]}]"), ErrorCode::kParse,
                "expected two metrics in its parentheses, got 1"},
        BadText{"no_axis", With("plots: [{x: pairs, y: mean(nees)}]"), ErrorCode::kParse,
                "'pairs' is not an axis of the grid; known are index"},
        BadText{"bad_name", With("name: a/b"), ErrorCode::kParse, "got 'a/b'"},
        BadText{"not_yaml", "kind: [", ErrorCode::kParse, "not valid YAML"}),
    [](const testing::TestParamInfo<BadText>& bad) { return std::string(bad.param.name); });

TEST(TrialKinds, AreDocumented) {
  for (const TrialKind& kind : BuiltinKinds()) {
    EXPECT_FALSE(kind.summary.empty()) << kind.name;
    EXPECT_FALSE(kind.metrics.empty()) << kind.name;
    EXPECT_LE(kind.metrics.size(), kMaxMetrics) << kind.name;
    EXPECT_LT(kind.trials_per_block, 0x10000) << kind.name;
    for (const OptionDoc& parameter : kind.parameters) {
      EXPECT_FALSE(parameter.meaning.empty()) << kind.name << " " << parameter.name;
      EXPECT_NE(parameter.name, "name") << kind.name << ": the key of a condition";
      EXPECT_NE(parameter.name, "solvers") << kind.name << ": the key of a condition";
    }
  }
}

// Every experiment of the repository is valid.
TEST(Experiments, OfTheRepositoryAreValid) {
  SolverRegistry registry = BuiltinSolvers();
  AddOpenCvSolvers(registry);
  int count = 0;
  std::string without_data;
  for (const auto& entry : std::filesystem::directory_iterator(SourceRoot() / "experiments")) {
    if (entry.path().extension() != ".yaml") continue;
    const Expected<Experiment> experiment = ReadExperiment(entry.path(), BuiltinKinds(), registry);
    ++count;
    if (!experiment && experiment.error().code == ErrorCode::kMissingData && !RealDataFolder()) {
      without_data += " " + entry.path().filename().string();
      continue;
    }
    EXPECT_TRUE(experiment) << experiment.error().message;
  }
  EXPECT_GT(count, 0);
  if (!without_data.empty()) GTEST_SKIP() << "REAL DATA ABSENT: set SEXTANT_DATA;" << without_data;
}

}  // namespace
}  // namespace sextant::test
