// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_session.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace sextant::cli {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kWidth = 640;

// Four rings of returns, 10 pixels apart in both directions.
std::vector<ProjectedReturn> Grid() {
  std::vector<ProjectedReturn> returns;
  for (int ring = 0; ring < 4; ++ring) {
    for (int u = 0; u < kWidth; u += 10) {
      returns.push_back({.pixel = {u, 100 + 10 * ring}, .range_m = 2.0, .ring = ring});
    }
  }
  return returns;
}

MarkSession NewSession(std::vector<int> ids = {}) {
  return MarkSession(Grid(), {.camera = AssumedCamera(kWidth, 480)}, std::move(ids));
}

// A square of 20 pixels around two rings and two columns.
void DrawSquare(MarkSession& session, double u, double v = 95.0) {
  session.Click({u, v});
  session.Click({u + 20.0, v});
  session.Click({u + 20.0, v + 20.0});
  session.Click({u, v + 20.0});
}

void DrawBoard(MarkSession& session, double u) {
  for (int edge = 0; edge < 4; ++edge) DrawSquare(session, u + 25.0 * edge);
}

std::vector<int> IdsOf(const MarkSession& session) {
  std::vector<int> ids;
  for (const MarkedBoard& board : session.marks().boards) ids.push_back(board.id);
  return ids;
}

TEST(MarkSession, FourClicksMakeAnEdgeAndFourEdgesABoard) {
  MarkSession session = NewSession();
  EXPECT_THAT(session.Prompt(), HasSubstr("Board 0, top-left edge (1 of 4): click corner 1 of 4"));
  session.Click({5.004, 95.0});
  EXPECT_THAT(session.Prompt(), HasSubstr("click corner 2 of 4"));
  EXPECT_EQ(session.marks().unfinished.size(), 1U);
  session.Click({25.0, 95.0});
  session.Click({25.0, 115.0});
  session.Click({5.0, 115.0});
  EXPECT_TRUE(session.marks().unfinished.empty());
  ASSERT_EQ(session.marks().boards.size(), 1U);
  const Quadrilateral expected = {Eigen::Vector2d(5, 95), Eigen::Vector2d(25, 95),
                                  Eigen::Vector2d(25, 115), Eigen::Vector2d(5, 115)};
  EXPECT_EQ(session.marks().boards[0].edges[0], expected);
  // Columns 10 and 20, rings at 100 and 110.
  EXPECT_THAT(session.note(), HasSubstr("top-left edge of board 0: 4 returns on 2 rings"));
  EXPECT_THAT(session.Prompt(), HasSubstr("top-right edge (2 of 4)"));
  for (int edge = 1; edge < 4; ++edge) DrawSquare(session, 25.0 * edge);
  EXPECT_EQ(session.marks().boards[0].edges.size(), 4U);
  EXPECT_THAT(session.Prompt(), HasSubstr("Next board to the right (1)"));
  DrawBoard(session, 300.0);
  EXPECT_THAT(IdsOf(session), ElementsAre(0, 1));
  EXPECT_THAT(session.Warnings(), IsEmpty());
}

TEST(MarkSession, ClicksThatCrossAreSortedAndClicksOnALineRefused) {
  MarkSession session = NewSession();
  session.Click({0, 90});
  session.Click({20, 110});
  session.Click({20, 90});
  session.Click({0, 110});
  ASSERT_EQ(session.marks().boards.size(), 1U);
  const Quadrilateral edge = session.marks().boards[0].edges[0];
  EXPECT_FALSE(CrossesItself(edge));
  EXPECT_TRUE(Contains(edge, {10, 92}));
  EXPECT_TRUE(Contains(edge, {2, 100}));
  for (int i = 0; i < 4; ++i) session.Click({10.0 * i, 100.0});
  EXPECT_EQ(session.marks().boards[0].edges.size(), 1U);
  EXPECT_THAT(session.note(), HasSubstr("enclose no area"));
  EXPECT_TRUE(session.marks().unfinished.empty());
}

TEST(MarkSession, UndoTakesBackEveryClickAndRedoBringsItAgain) {
  MarkSession session = NewSession();
  DrawBoard(session, 10.0);
  const int revision = session.revision();
  const std::vector<Quadrilateral> edges = session.marks().boards[0].edges;
  EXPECT_TRUE(session.Undo());
  EXPECT_EQ(session.marks().boards[0].edges.size(), 3U);
  EXPECT_EQ(session.marks().unfinished.size(), 3U);
  for (int i = 0; i < 15; ++i) EXPECT_TRUE(session.Undo());
  EXPECT_TRUE(session.marks().boards.empty());
  EXPECT_TRUE(session.marks().unfinished.empty());
  EXPECT_FALSE(session.Undo());
  EXPECT_EQ(session.note(), "nothing to undo");
  for (int i = 0; i < 16; ++i) EXPECT_TRUE(session.Redo());
  EXPECT_FALSE(session.Redo());
  EXPECT_EQ(session.marks().boards[0].edges, edges);
  EXPECT_EQ(session.revision(), revision);
  session.Undo();
  session.Click({1.0, 1.0});
  EXPECT_FALSE(session.Redo());  // A new change leaves nothing to redo.
}

TEST(MarkSession, KnowsWhatIsSaved) {
  MarkSession session = NewSession();
  EXPECT_TRUE(session.IsSaved());
  DrawSquare(session, 10.0);
  EXPECT_FALSE(session.IsSaved());
  session.MarkSaved();
  EXPECT_TRUE(session.IsSaved());
  session.SetMode(MarkMode::kCorners);  // A choice is no change of the marks.
  session.SetMode(MarkMode::kEdges);
  EXPECT_TRUE(session.IsSaved());
  session.Click({50.0, 50.0});
  EXPECT_FALSE(session.IsSaved());
  session.Undo();
  EXPECT_TRUE(session.IsSaved());
  for (int i = 0; i < 3; ++i) session.Undo();
  EXPECT_FALSE(session.IsSaved());
  session.Click({7.0, 7.0});  // Another change after an undo is not the one that was saved.
  EXPECT_FALSE(session.IsSaved());
}

TEST(MarkSession, ADeletedBoardIsDrawnAgainInItsPlace) {
  MarkSession session = NewSession({26, 582});
  DrawBoard(session, 10.0);
  DrawBoard(session, 300.0);
  EXPECT_THAT(IdsOf(session), ElementsAre(26, 582));
  session.SelectBoard(-2);
  EXPECT_EQ(session.selected_id(), 26);
  session.DeleteBoard();
  EXPECT_THAT(IdsOf(session), ElementsAre(582));
  DrawBoard(session, 20.0);
  EXPECT_THAT(IdsOf(session), ElementsAre(26, 582));  // Left to right.
  for (int i = 0; i < 17; ++i) session.Undo();
  EXPECT_THAT(IdsOf(session), ElementsAre(26, 582));
  EXPECT_EQ(session.marks().boards[0].edges[0][0], Eigen::Vector2d(10.0, 95.0));
}

TEST(MarkSession, DeleteWithNothingDrawnYetTakesTheBoardBefore) {
  MarkSession session = NewSession();
  session.DeleteBoard();
  EXPECT_EQ(session.note(), "no board to delete");
  DrawBoard(session, 10.0);
  session.DeleteBoard();
  EXPECT_TRUE(session.marks().boards.empty());
  EXPECT_EQ(session.selected_id(), 0);
}

TEST(MarkSession, BoardsAreChosenUpToTheFirstEmptyOne) {
  MarkSession session = NewSession();
  session.SelectBoard(+1);
  EXPECT_EQ(session.selected_id(), 0);
  DrawBoard(session, 10.0);
  EXPECT_EQ(session.selected_id(), 1);
  session.SelectBoard(+5);
  EXPECT_EQ(session.selected_id(), 1);
  session.SelectBoard(-7);
  EXPECT_EQ(session.selected_id(), 0);
  session.Click({1.0, 1.0});
  EXPECT_THAT(session.note(), HasSubstr("board 0 has all its edges"));
  EXPECT_TRUE(session.marks().unfinished.empty());
}

TEST(MarkSession, CornersAreClickedFromTheTopClockwise) {
  MarkSession session = NewSession();
  session.SetMode(MarkMode::kCorners);
  EXPECT_THAT(session.Prompt(), HasSubstr("Board 0: click its top corner in the photo (1 of 4)"));
  for (int i = 0; i < 8; ++i) session.Click({10.0 * i, 7.0});
  ASSERT_EQ(session.marks().corners.size(), 8U);
  for (int i = 0; i < 8; ++i) {
    const ClickedCorner& corner = session.marks().corners[static_cast<std::size_t>(i)];
    EXPECT_EQ(corner.board, i / 4);
    EXPECT_EQ(corner.corner, i % 4);
    EXPECT_EQ(corner.pixel, Eigen::Vector2d(10.0 * i, 7.0));
  }
  EXPECT_TRUE(session.marks().boards.empty());
  session.DeleteBoard();
  EXPECT_EQ(session.marks().corners.size(), 4U);
  session.SetMode(MarkMode::kEdges);
  EXPECT_EQ(session.selected_id(), 0);
  DrawBoard(session, 10.0);
  EXPECT_THAT(IdsOf(session), ElementsAre(0));
}

TEST(MarkSession, GoesOnWhereAFileStopped) {
  MarkSession first = NewSession({7});
  DrawBoard(first, 10.0);
  DrawSquare(first, 300.0);
  first.Click({330.0, 90.0});
  MarkSession session(Grid(), first.marks());
  EXPECT_EQ(session.selected_id(), 8);
  EXPECT_THAT(session.Prompt(), HasSubstr("Board 8, top-right edge (2 of 4): click corner 2 of 4"));
  EXPECT_TRUE(session.IsSaved());
}

TEST(MarkSession, WarnsOfBoardsOutOfOrderAndOfEdgesWithoutRings) {
  MarkSession session = NewSession();
  DrawBoard(session, 300.0);
  DrawBoard(session, 10.0);
  EXPECT_THAT(session.Warnings(),
              ElementsAre(HasSubstr("board 1 is to the left of the one before")));
  DrawSquare(session, 500.0, 200.0);
  DrawSquare(session, 530.0, 82.0);  // One ring, at 100.
  EXPECT_THAT(
      session.Warnings(),
      ElementsAre(
          testing::_, HasSubstr("board 2: its top-left edge has returns of 0 rings"),
          HasSubstr("board 2: its top-right edge has returns of 1 rings, and a line needs 2")));
}

}  // namespace
}  // namespace sextant::cli
