// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/left_out.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sextant {
namespace {

using testing::HasSubstr;

std::vector<SessionView> ViewsNamed(const std::vector<std::string>& names) {
  std::vector<SessionView> views;
  for (const std::string& name : names) views.push_back({.name = name});
  return views;
}

Assembly AssemblyOf(int views) {
  Assembly assembly;
  assembly.problem.boards = {{.id = 7, .top_right_m = 0.5, .right_bottom_m = 0.5}};
  for (int view = 0; view < views; ++view) {
    assembly.matching.kept.push_back({.view = view});
    assembly.problem.board_views.push_back({.view = view, .board = 7});
    Pair3d3d pair;
    pair.id = {.view = view, .board = 7, .corner = 0};
    assembly.problem.pairs_3d3d.push_back(pair);
    assembly.rows.push_back({.view = static_cast<std::size_t>(view), .board = 0});
  }
  return assembly;
}

TEST(LeaveOut, RemovesTheBoardEverywhereAndItsRowStatesIt) {
  Assembly assembly = AssemblyOf(3);
  SolveReport report;
  report.inliers = {0, 2};
  for (int i = 0; i < 3; ++i) {
    report.board_views.push_back(
        {.view = i, .board = 7, .used = i != 1, .printed = {4, 4}, .face = {9, 9}});
  }
  LeaveOut(report, assembly);
  EXPECT_EQ(report.board_views.size(), 2U);
  EXPECT_EQ(report.evaluation.per_pair_m.size(), 2U);
  EXPECT_THAT(report.inliers, testing::ElementsAre(0, 1));
  ASSERT_EQ(assembly.problem.board_views.size(), 2U);
  EXPECT_EQ(assembly.problem.board_views[1].view, 2);
  EXPECT_EQ(assembly.problem.pairs_3d3d.size(), 2U);
  EXPECT_EQ(assembly.matching.kept[1].view, 2);
  EXPECT_EQ(assembly.rows[0].fate, BoardStatus::kKept);
  EXPECT_EQ(assembly.rows[1].fate, BoardStatus::kContradicts);
  EXPECT_THAT(assembly.rows[1].why, HasSubstr("contradict the other views"));
}

TEST(LeaveOut, ChangesNothingWhereAllOrNoneAreUsed) {
  Assembly assembly = AssemblyOf(2);
  SolveReport report;
  LeaveOut(report, assembly);
  report.board_views = {{.view = 0, .board = 7, .used = true},
                        {.view = 1, .board = 7, .used = true}};
  LeaveOut(report, assembly);
  for (BoardViewFit& fit : report.board_views) fit.used = false;
  LeaveOut(report, assembly);
  EXPECT_EQ(report.board_views.size(), 2U);
  EXPECT_EQ(assembly.problem.board_views.size(), 2U);
}

TEST(WithViewNames, ReplacesNumbersOfViewsOnly) {
  const std::vector<SessionView> views = ViewsNamed({"pose2", "18", ""});
  EXPECT_EQ(WithViewNames("board 0 of view 1 was left out", views),
            "board 0 of view 18 was left out");
  EXPECT_EQ(WithViewNames("view 0, view 2 and view 9", views), "view pose2, view 2 and view 9");
  EXPECT_EQ(WithViewNames("one view only, views 0 and 1", views), "one view only, views 0 and 1");
  EXPECT_EQ(WithViewNames("view ", views), "view ");
}

}  // namespace
}  // namespace sextant
