// SPDX-License-Identifier: Apache-2.0
#include "calibrate/capture/live_session.h"

#include <gtest/gtest.h>

namespace sextant {
namespace {

TEST(DescribeSighting, NamesTheBoardsOfThePhotoAndCountsThoseOfTheScan) {
  const std::vector<Board> boards = {Board{.id = 3}, Board{.id = 8}};
  SessionView view{.name = "7"};
  view.seen = Observation{};
  EXPECT_EQ(DescribeSighting(view, boards), "7: no board in the photo; no board in the scan");
  view.seen->in_image.push_back({.board = 1});
  view.seen->in_scan.resize(1);
  EXPECT_EQ(DescribeSighting(view, boards),
            "7: board 8 in the photo; 1 possible board in the scan");
  view.seen->in_image.push_back({.board = 0});
  view.seen->in_scan.resize(3);
  EXPECT_EQ(DescribeSighting(view, boards),
            "7: boards 8, 3 in the photo; 3 possible boards in the scan");
  // What the scan lacks is named only where it shows no board.
  view.seen->missing = {{.why = "too few rings"}};
  EXPECT_EQ(DescribeSighting(view, boards),
            "7: boards 8, 3 in the photo; 3 possible boards in the scan");
  view.seen->in_scan.clear();
  EXPECT_EQ(DescribeSighting(view, boards),
            "7: boards 8, 3 in the photo; no board in the scan (too few rings)");
}

TEST(DescribeSighting, StatesWhyAViewCannotBeRead) {
  SessionView view{.name = "7"};
  view.seen = MakeError(ErrorCode::kParse, "7.png: it is cut short");
  EXPECT_EQ(DescribeSighting(view, {}), "7: 7.png: it is cut short");
}

}  // namespace
}  // namespace sextant
