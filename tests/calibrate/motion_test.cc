// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/motion.h"

#include <gmock/gmock.h>

namespace sextant::test {
namespace {

const Camera kCamera{.width_px = 1280,
                     .height_px = 720,
                     .fx_px = 700.0,
                     .fy_px = 700.0,
                     .cx_px = 640.0,
                     .cy_px = 360.0};

// A view of a board 2 m away whose tag is `x_m` to the right.
SessionView ViewAt(double x_m) {
  CameraSighting sighting{.board = 0};
  sighting.pose.cam_from_board.translation = {0.0, 0.0, 2.0};
  BoardPoints points;
  for (int i = 0; i < 4; ++i) {
    points.in_board_m.emplace_back(0.1 * i, 0.1 * i);
    points.pixels.emplace_back(640.0 + 350.0 * (x_m + 0.1 * i), 360.0 + 35.0 * i);
  }
  sighting.printed = {points};
  SessionView view;
  view.seen = Observation{.in_image = {sighting}};
  return view;
}

std::vector<std::string> Reasons(const std::vector<SessionView>& views) {
  std::vector<std::string> reasons;
  for (const SessionView& view : views) reasons.push_back(view.seen->in_image[0].left_out);
  return reasons;
}

TEST(Motion, PixelsAtTheBoardsRange) {
  const std::optional<double> moved =
      MovedBetween(ViewAt(0.0).seen->in_image[0], ViewAt(0.03).seen->in_image[0], kCamera);
  ASSERT_TRUE(moved);
  EXPECT_NEAR(*moved, 0.03, 1e-12);
}

TEST(Motion, AMovingBoardIsLeftOutAndAStillOneKept) {
  // Still, carried on at 1 m/s, still again.
  std::vector<SessionView> views;
  for (const double x : {0.0, 0.001, 0.0, 0.1, 0.2, 0.3, 0.4, 0.4, 0.401}) {
    views.push_back(ViewAt(x));
  }
  const std::vector<double> times = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8};
  LeaveOutMotion(views, times, kCamera);
  const std::vector<std::string> reasons = Reasons(views);
  for (const std::size_t still : {0U, 1U, 2U, 6U, 7U, 8U}) EXPECT_EQ(reasons[still], "") << still;
  for (const std::size_t moving : {3U, 4U, 5U}) {
    EXPECT_THAT(reasons[moving], testing::HasSubstr("it moves, by 1.00 m/s")) << moving;
  }
}

TEST(Motion, ViewsFarApartDoNotTestMotion) {
  std::vector<SessionView> views = {ViewAt(0.0), ViewAt(0.5), ViewAt(1.0)};
  LeaveOutMotion(views, std::vector<double>{0.0, 10.0, 20.0}, kCamera);
  EXPECT_THAT(Reasons(views), testing::Each(""));
}

TEST(Motion, OfOnePlaceAFewAreKept) {
  std::vector<SessionView> views;
  std::vector<double> times;
  for (int i = 0; i < 40; ++i) {
    views.push_back(ViewAt(i < 30 ? 0.0 : 0.5));
    times.push_back(0.1 * i + (i < 30 ? 0.0 : 5.0));
  }
  LeaveOutMotion(views, times, kCamera);
  const std::vector<std::string> reasons = Reasons(views);
  EXPECT_EQ(std::count(reasons.begin(), reasons.begin() + 30, ""), 5);
  EXPECT_EQ(std::count(reasons.begin() + 30, reasons.end(), ""), 5);
  EXPECT_THAT(reasons[1], testing::HasSubstr("5 of 30"));
}

TEST(Motion, BoardsThatAreNotSeenAreNoMatter) {
  std::vector<SessionView> views(3);
  views[0] = ViewAt(0.0);
  views[1].seen = MakeError(ErrorCode::kParse, "broken");
  views[2].seen = Observation{};
  LeaveOutMotion(views, std::vector<double>{0.0, 0.1, 0.2}, kCamera);
  EXPECT_EQ(views[0].seen->in_image[0].left_out, "");
}

}  // namespace
}  // namespace sextant::test
