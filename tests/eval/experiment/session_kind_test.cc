// SPDX-License-Identifier: Apache-2.0
// Whole rendered sessions with known truth, healthy and with a fault.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "calibrate/trust/verdict.h"
#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/kinds/session_fault.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

using testing::AnyOf;
using testing::HasSubstr;

Expected<Experiment> Parse(const std::string& parameters) {
  return ParseExperiment(
      "kind: session\ntrials: 1\nsolvers: [joint(gnc(kabsch)), kabsch]\nparameters: {scene: "
      "scenes/printed_board.yaml, bootstrap: 0" +
          parameters + "}\n",
      (SourceRoot() / "experiments" / "try.yaml").string(), BuiltinKinds(), BuiltinSolvers());
}

// The row of the first trial of the only condition: one value for each metric.
struct Row {
  Row(const Experiment& experiment, std::size_t subject) : metrics(experiment.metrics) {
    TrialRows rows(metrics.size(), experiment.wanted);
    rows.BeginTrial(0);
    experiment.conditions[0].trials->Run({0, 1}, rows);
    const auto first =
        rows.values().begin() + static_cast<std::ptrdiff_t>(subject * metrics.size());
    values.assign(first, first + static_cast<std::ptrdiff_t>(metrics.size()));
  }
  double operator[](const std::string& name) const {
    for (std::size_t i = 0; i < metrics.size(); ++i) {
      if (metrics[i].name == name) return values[i];
    }
    ADD_FAILURE() << "no metric " << name;
    return 0.0;
  }
  std::vector<Metric> metrics;
  std::vector<double> values;
};

TEST(SessionKind, MeasuresTheAnswerAgainstTruthAndBound) {
  const Expected<Experiment> experiment = Parse(", views: 4");
  ASSERT_TRUE(experiment) << experiment.error().message;
  const Row row(*experiment, 0);
  EXPECT_EQ(row["answered"], 1.0);
  EXPECT_GE(row["views_used"], 3.0);
  EXPECT_GT(row["bound_translation_mm"], 0.5);
  EXPECT_LT(row["bound_translation_mm"], 15.0);
  // Beyond six times the bound would be an error, not noise.
  EXPECT_LT(row["translation_mm"], 6.0 * row["bound_translation_mm"]);
  EXPECT_EQ(row["good"] + row["care"] + row["not_usable"], 1.0);
  EXPECT_TRUE(std::isnan(row["cause_named"]));
}

TEST(SessionKind, TheWordsOnAFaultAreJudged) {
  const Expected<Experiment> experiment = Parse(", views: 3, fault: focal_length");
  ASSERT_TRUE(experiment) << experiment.error().message;
  const Row row(*experiment, 0);
  EXPECT_EQ(row["good"], 0.0) << "without a bootstrap nothing is GOOD";
  EXPECT_EQ(row["care"] + row["not_usable"], 1.0);
  EXPECT_THAT(row["cause_named"], AnyOf(0.0, 1.0));
}

TEST(SessionKind, RefusesWhatCannotBeRecorded) {
  const auto message = [](const std::string& parameters) {
    const Expected<Experiment> experiment = Parse(parameters);
    return experiment ? std::string() : experiment.error().message;
  };
  EXPECT_THAT(message(", nearest_m: 3.0, farthest_m: 2.0"), HasSubstr("is below nearest_m"));
  EXPECT_THAT(message(", nearest_m: 0.3, farthest_m: 0.31"), HasSubstr("found no place"));
  EXPECT_THAT(message(", fault: broken"), HasSubstr("broken"));
}

TEST(SessionFault, StatesAreWrongAsNamed) {
  Board board{.id = 0, .top_right_m = 0.6, .right_bottom_m = 0.4};
  board.tags = {{.family = "tag36h11", .id = 0, .edge_m = 0.2}};
  EXPECT_EQ(StatedBoard(board, SessionFault::kNone).tags[0].edge_m, 0.2);
  EXPECT_DOUBLE_EQ(StatedBoard(board, SessionFault::kBoardSize).top_right_m, 0.612);
  EXPECT_DOUBLE_EQ(StatedBoard(board, SessionFault::kSquareSize).tags[0].edge_m, 0.206);
  EXPECT_EQ(StatedBoard(board, SessionFault::kSquareSize).top_right_m, 0.6);
  EXPECT_EQ(StatedBoard(board, SessionFault::kPrintShifted).tags[0].center_in_board_m.x(), 0.03);
  EXPECT_EQ(NamesCause(SessionFault::kSensorMoved, "Check whether a sensor moved"), true);
  EXPECT_EQ(NamesCause(SessionFault::kSensorMoved, "Add views"), false);
  EXPECT_EQ(NamesCause(SessionFault::kNone, "Add views"), std::nullopt);
}

// NamesCause looks for words that the verdict on such a session uses.
TEST(SessionFault, IsNamedByTheVerdictOnIt) {
  const auto names = [](SessionFault fault, const VerdictFigures& figures) {
    const ResultVerdict verdict = JudgeResult(figures);
    return NamesCause(fault, verdict.reason + "\n" + verdict.next);
  };
  const VerdictFigures ranges{.range_excess = 0.03, .range_excess_sigma = 0.002};
  const VerdictFigures halves{.halves_off = 6.0};
  const VerdictFigures moments{.views_with_board = 10, .views_used = 5, .views_contradicting = 5};
  const VerdictFigures prints{.print_rms_px = 5.0, .print_over_noise = 10.0};
  EXPECT_EQ(names(SessionFault::kFocalLength, ranges), true);
  EXPECT_EQ(names(SessionFault::kSquareSize, ranges), true);
  EXPECT_EQ(names(SessionFault::kBoardSize, ranges), true);
  EXPECT_EQ(names(SessionFault::kSensorMoved, halves), true);
  EXPECT_EQ(names(SessionFault::kExchangedScans, moments), true);
  EXPECT_EQ(names(SessionFault::kUnsynchronised, moments), true);
  EXPECT_EQ(names(SessionFault::kOtherLens, prints), true);
  EXPECT_EQ(names(SessionFault::kSensorMoved, ranges), false);
  EXPECT_EQ(names(SessionFault::kFocalLength, halves), false);
  EXPECT_EQ(names(SessionFault::kFocalLength, moments), false);
  EXPECT_EQ(names(SessionFault::kExchangedScans, prints), false);
}

}  // namespace
}  // namespace sextant::test
