// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/reproduction/claims.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "eval/experiment/reproduction/judge_claim.h"
#include "solvers/builtin_solvers.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

Verdict Of(ClaimRule rule, double value, Interval ours, std::optional<Interval> than = {}) {
  Claim claim;
  claim.rule = rule;
  claim.value = value;
  return VerdictOf(claim, ours, than);
}

TEST(Claims, VerdictsFollowFromIntervals) {
  using R = ClaimRule;
  using V = Verdict;
  EXPECT_EQ(Of(R::kDraw, 1.5, {1.0, 2.0}), V::kReproduced);
  EXPECT_EQ(Of(R::kDraw, 2.5, {1.0, 2.0}), V::kRefuted);
  EXPECT_EQ(Of(R::kAbout, 1.0, {1.9, 3.0}), V::kReproduced);
  EXPECT_EQ(Of(R::kAbout, 1.0, {2.1, 3.0}), V::kRefuted);
  EXPECT_EQ(Of(R::kAbout, 1.0, {0.3, 0.49}), V::kRefuted);
  EXPECT_EQ(Of(R::kAtMost, 2.0, {1.0, 2.0}), V::kReproduced);
  EXPECT_EQ(Of(R::kAtMost, 1.5, {1.0, 2.0}), V::kUndecided);
  EXPECT_EQ(Of(R::kAtMost, 0.5, {1.0, 2.0}), V::kRefuted);
  EXPECT_EQ(Of(R::kAtLeast, 1.0, {1.0, 2.0}), V::kReproduced);
  EXPECT_EQ(Of(R::kAtLeast, 2.5, {1.0, 2.0}), V::kRefuted);
  EXPECT_EQ(Of(R::kLess, 0.0, {1.0, 2.0}, Interval{3.0, 4.0}), V::kDirection);
  EXPECT_EQ(Of(R::kLess, 0.0, {1.0, 3.5}, Interval{3.0, 4.0}), V::kUndecided);
  EXPECT_EQ(Of(R::kLess, 0.0, {5.0, 6.0}, Interval{3.0, 4.0}), V::kRefuted);
  EXPECT_EQ(Of(R::kSimilar, 0.0, {5.0, 6.0}, Interval{3.0, 4.0}), V::kReproduced);
  EXPECT_EQ(Of(R::kSimilar, 0.0, {9.0, 9.5}, Interval{3.0, 4.0}), V::kRefuted);
  EXPECT_EQ(Of(R::kUntested, 0.0, {}), V::kNotTestable);
}

constexpr const char* kFile = R"(paper: a paper
experiments: [one]
claims:
  - {id: a, where: Table 1, text: t, printed: 3 m, value: 3, rule: draw, ours: {experiment: one, subject: s, statistic: mean(x)}}
  - {id: b, where: Table 2, text: t, printed: '-', rule: untested, why: because}
errata:
  - {where: e, printed: p, is: i}
)";

std::string Refusal(std::string text, const std::string& from, const std::string& to) {
  text.replace(text.find(from), from.size(), to);
  const Expected<ClaimsFile> file = ParseClaims(text, "c.yaml");
  return file ? "nothing refused" : file.error().message;
}

TEST(Claims, ParsesAClaimsFile) {
  const Expected<ClaimsFile> file = ParseClaims(kFile, "c.yaml");
  ASSERT_TRUE(file) << file.error().message;
  ASSERT_EQ(file->claims.size(), 2U);
  EXPECT_EQ(file->claims[0].rule, ClaimRule::kDraw);
  EXPECT_EQ(file->claims[0].value, 3.0);
  EXPECT_EQ(file->claims[0].ours->subject, "s");
  EXPECT_EQ(file->claims[1].rule, ClaimRule::kUntested);
  EXPECT_EQ(file->errata[0].is, "i");
  EXPECT_THAT(Refusal(kFile, "rule: draw", "rule: drew"), HasSubstr("draw"));
  EXPECT_THAT(Refusal(kFile, "experiment: one", "experiment: two"), HasSubstr("one"));
  EXPECT_THAT(Refusal(kFile, ", why: because", ""), HasSubstr("expected the reason"));
  EXPECT_THAT(Refusal(kFile, "value: 3, ", ""), HasSubstr("value"));
  EXPECT_THAT(Refusal(kFile, "where: Table 1", "were: Table 1"), HasSubstr("where"));
}

// Every claim names an existing condition, subject and statistic of its experiment. Experiments on
// real data are checked only if the data is available.
TEST(Claims, ReferToExistingConditionsSubjectsAndStatistics) {
  const Expected<ClaimsFile> file = ReadClaims(SourceRoot() / "paper" / "claims.yaml");
  ASSERT_TRUE(file) << file.error().message;
  std::map<std::string, Experiment> experiments;
  for (const std::string& name : file->experiments) {
    Expected<Experiment> experiment = ReadExperiment(
        SourceRoot() / "experiments" / (name + ".yaml"), BuiltinKinds(), BuiltinSolvers());
    if (!experiment && experiment.error().code == ErrorCode::kMissingData) continue;
    ASSERT_TRUE(experiment) << experiment.error().message;
    experiments.emplace(name, std::move(*experiment));
  }
  std::vector<ClaimFigure> figures;
  for (const Claim& claim : file->claims) {
    if (claim.ours) figures.push_back(*claim.ours);
    if (claim.than) figures.push_back(*claim.than);
  }
  EXPECT_GT(figures.size(), 50U);
  for (const ClaimFigure& figure : figures) {
    const auto found = experiments.find(figure.experiment);
    if (found == experiments.end()) continue;
    const auto& conditions = found->second.conditions;
    const auto condition =
        std::ranges::find(conditions, figure.condition, [](const Condition& c) { return c.name; });
    ASSERT_NE(condition, conditions.end()) << figure.experiment << ": " << figure.condition;
    EXPECT_THAT(condition->trials->subjects(), testing::Contains(figure.subject));
    const auto statistic = ParseStatistic(figure.statistic, found->second.metrics);
    EXPECT_TRUE(statistic) << figure.statistic;
  }
}

}  // namespace
}  // namespace sextant::test
