// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/repeated_views.h"

#include <gmock/gmock.h>

#include "calibrate/match/assemble.h"
#include "support/fake_observation.h"

namespace sextant::test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

struct RepeatedSession {
  std::vector<SessionView> views;
  std::vector<Board> boards = {SquareBoard(0)};
  Camera camera{.width_px = 1280,
                .height_px = 720,
                .fx_px = 700.0,
                .fy_px = 700.0,
                .cx_px = 639.5,
                .cy_px = 359.5};

  // A view of the board at the place, with noise of its own.
  void Add(const Rigid3d& place, Random& random) {
    SessionView view{.name = std::to_string(views.size())};
    view.seen = FakeObservation(boards, std::span(&place, 1), kFakeCamFromLidar, random);
    views.push_back(std::move(view));
  }
};

TEST(RepeatedViews, CopiesAreLeftOut) {
  Random random(1);
  RepeatedSession session;
  for (int i = 0; i < 4; ++i) session.Add(PlacedAtRandom(random), random);
  const Expected<Assembly> once = Assemble(session.views, session.boards, session.camera);
  for (int i = 0; i < 10; ++i) session.views.push_back(session.views[1]);
  const Expected<Assembly> often = Assemble(session.views, session.boards, session.camera);
  ASSERT_TRUE(once && often);
  EXPECT_EQ(often->problem.pairs_3d3d.size(), once->problem.pairs_3d3d.size());
  EXPECT_THAT(often->repeated, IsEmpty());
  ASSERT_THAT(often->rows, SizeIs(14));
  EXPECT_EQ(often->rows[13].fate, BoardStatus::kCopy);
}

TEST(RepeatedViews, OnePlaceInManyViewsWeighsAsOneView) {
  Random random(2);
  RepeatedSession session;
  const Rigid3d place = PlacedAtRandom(random);
  for (int i = 0; i < 3; ++i) session.Add(PlacedAtRandom(random), random);
  for (int i = 0; i < 9; ++i) session.Add(place, random);
  const Expected<Assembly> assembly = Assemble(session.views, session.boards, session.camera);
  ASSERT_TRUE(assembly) << assembly.error().message;
  ASSERT_THAT(assembly->repeated, SizeIs(1));
  EXPECT_THAT(assembly->repeated[0].views, ElementsAre(3, 4, 5, 6, 7, 8, 9, 10, 11));
  // The information of the nine, as the sum of inverse variances, is that of one of the others.
  double of_nine = 0.0;
  double of_one = 0.0;
  for (const Pair3d3d& pair : assembly->problem.pairs_3d3d) {
    const double information = 1.0 / pair.covariance_in_cam->trace();
    if (pair.id.view >= 3) of_nine += information;
    if (pair.id.view == 0) of_one += information;
  }
  EXPECT_NEAR(of_nine, of_one, 1e-6 * of_one);
  EXPECT_THAT(ViewsThatShare(assembly->repeated), SizeIs(1));
}

TEST(RepeatedViews, ViewsThatShareAPlaceByWayOfOthersAreOneGroup) {
  const std::vector<RepeatedPlacement> placements = {
      {.board = 0, .views = {0, 2}}, {.board = 1, .views = {3, 4}}, {.board = 1, .views = {2, 5}}};
  EXPECT_THAT(ViewsThatShare(placements),
              testing::UnorderedElementsAre(ElementsAre(3, 4), ElementsAre(0, 2, 5)));
}

}  // namespace
}  // namespace sextant::test
