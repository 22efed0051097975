// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/score.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

namespace sextant {
namespace {

using testing::ElementsAre;

ComparisonRow RowWith(const std::string& solver, std::vector<double> residuals) {
  SolveReport report;
  report.solver = solver;
  double squares = 0.0;
  for (const double r : residuals) squares += r * r;
  report.evaluation.rmse_m = std::sqrt(squares / static_cast<double>(residuals.size()));
  report.evaluation.per_pair_m = std::move(residuals);
  return {solver, report, {}, {}};
}

std::vector<std::string> NamesByScore(std::vector<ComparisonRow> rows,
                                      const std::vector<SolverSpec>& specs) {
  std::vector<std::string> names;
  for (const ScoredRow& scored : SortByScore(std::move(rows), specs)) {
    names.push_back(scored.row.solver);
  }
  return names;
}

// An answer that keeps the start's rotation has no other place than its residuals give it.
TEST(SortByScore, GoesByTheResidualsOfAllPairsAlone) {
  std::vector<ComparisonRow> rows;
  rows.push_back(RowWith("lost", {4.0, 5.0, 4.0, 5.0, 6.0}));
  rows.push_back(RowWith("offset", {1.0, 1.1, 1.2, 0.9, 1.0}));
  rows.push_back(RowWith("good", {0.01, 0.02, 0.01, 0.02, 0.01}));
  rows.push_back({"none", MakeError(ErrorCode::kNoConsensus, "no"), {}, {}});
  const std::vector<SolverSpec> specs = {
      {.name = "lost"}, {.name = "offset", .estimates_rotation = false}, {.name = "good"}, {}};
  EXPECT_THAT(NamesByScore(std::move(rows), specs), ElementsAre("good", "offset", "lost", "none"));
}

// It leaves the worst pair out, and is held to it all the same.
TEST(SortByScore, HoldsAnAnswerToThePairsThatItLeftOut) {
  std::vector<ComparisonRow> rows;
  rows.push_back(RowWith("drops a good pair", {0.01, 0.01, 0.01, 0.01, 0.01, 0.5}));
  rows.push_back(RowWith("keeps all", {0.012, 0.012, 0.012, 0.012, 0.012, 0.012}));
  rows.front().report->inliers = {0, 1, 2, 3, 4};
  EXPECT_THAT(NamesByScore(std::move(rows), {{}, {}}),
              ElementsAre("keeps all", "drops a good pair"));
}

// Residuals of normal noise. The smaller half of some answer is always small by chance, and must
// not make the scale so small that this half decides.
TEST(SortByScore, SmallResidualsOfHalfThePairsDecideNothing) {
  std::vector<ComparisonRow> rows;
  rows.push_back(RowWith("half", {0.2, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 1.3, 1.5, 1.6}));
  rows.push_back(RowWith("best", {0.4, 0.5, 0.6, 0.7, 0.7, 0.8, 0.9, 0.9, 1.0, 1.0}));
  EXPECT_THAT(NamesByScore(std::move(rows), {{}, {}}), ElementsAre("best", "half"));
}

}  // namespace
}  // namespace sextant
