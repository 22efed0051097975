// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/match.h"

#include <gmock/gmock.h>

#include <numbers>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "calibrate/match/sensor_agreement.h"
#include "geometry/scan_marks.h"
#include "geometry/so3.h"
#include "support/fake_observation.h"

namespace sextant::test {
namespace {

std::vector<Board> Squares(int count) {
  std::vector<Board> boards;
  for (int i = 0; i < count; ++i) boards.push_back(SquareBoard(i));
  return boards;
}

// Boards apart: 1.2 m from the middle of one to that of the next.
std::vector<Rigid3d> Apart(std::size_t count, Random& random) {
  std::vector<Rigid3d> poses;
  for (std::size_t i = 0; i < count; ++i) {
    poses.push_back(PlacedAtRandom(random));
    poses.back().translation.x() =
        1.2 * (static_cast<double>(i) - 0.5 * (static_cast<double>(count) - 1.0));
  }
  return poses;
}

Camera FakeCamera() { return AssumedCamera(1280, 960); }

struct Faked {
  std::vector<Observation> views;
  std::vector<Board> boards;
};

Faked Fake(int views, int boards, std::uint64_t seed) {
  Random random(DeriveSeed(1, "match", static_cast<std::uint64_t>(boards), seed));
  Faked faked{.views = {}, .boards = Squares(boards)};
  for (int i = 0; i < views; ++i) {
    const std::vector<Rigid3d> poses = Apart(faked.boards.size(), random);
    faked.views.push_back(FakeObservation(faked.boards, poses, kFakeCamFromLidar, random));
  }
  return faked;
}

// Patches are listed last board first, so the true patch of board b is the count less b less 1.
void ExpectTrueMatches(const Faked& faked, const Matching& matching) {
  for (const MatchedBoard& kept : matching.kept) {
    EXPECT_EQ(kept.patch, static_cast<int>(faked.boards.size()) - 1 - kept.sighting);
    const BoardPlacement& placement = faked.views[static_cast<std::size_t>(kept.view)]
                                          .in_scan[static_cast<std::size_t>(kept.patch)]
                                          .placements[static_cast<std::size_t>(kept.placement)];
    EXPECT_EQ(placement.turn, 0);
    EXPECT_EQ(placement.board, kept.sighting);
  }
}

TEST(Match, EveryBoardOfManyViewsWhateverItsPlaceAndTurn) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Faked faked = Fake(4, 2, seed);
    const Expected<Matching> matching = MatchViews(faked.views);
    ASSERT_TRUE(matching) << matching.error().message;
    EXPECT_EQ(matching->kept.size(), 8U) << seed;
    ExpectTrueMatches(faked, *matching);
    EXPECT_TRUE(matching->alternatives.empty());
    const PoseDistance off = DistanceBetween(matching->cam_from_lidar, kFakeCamFromLidar);
    // Eight boards of 28 mrad each: one sigma of 10 mrad, and 20 mm at 2 m.
    EXPECT_LT(off.rotation_rad, 0.05);
    EXPECT_LT(off.translation_m, 0.1);
  }
}

TEST(Match, AnImageOfAnotherMomentIsDroppedWithHowFarItIsOff) {
  Faked faked = Fake(6, 1, 3);
  Random random(5);
  // The board was carried on by 20 cm between scan and image.
  const Rigid3d before = faked.views[2].in_image[0].pose.cam_from_board;
  Rigid3d after = before;
  after.translation.x() += 0.2;
  const Observation moved =
      FakeObservation(faked.boards, std::vector<Rigid3d>{after}, kFakeCamFromLidar, random);
  faked.views[2].in_image = moved.in_image;
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_TRUE(matching) << matching.error().message;
  EXPECT_EQ(matching->kept.size(), 5U);
  ASSERT_EQ(matching->dropped.size(), 1U);
  EXPECT_EQ(matching->dropped[0].match.view, 2);
  EXPECT_NEAR(matching->dropped[0].off_m, 0.2, 0.03);
}

TEST(Match, OneSquareBoardOnceIsAmbiguousAndTheAxesDecide) {
  const Faked faked = Fake(1, 1, 7);
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_TRUE(matching) << matching.error().message;
  EXPECT_EQ(matching->alternatives.size(), 3U);
  EXPECT_LT(RotationDistance(matching->cam_from_lidar.rotation, kFakeCamFromLidar.rotation), 0.1);
  const std::vector<std::string> lines = DescribeAmbiguity(*matching, {});
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_THAT(lines[0], testing::HasSubstr("ambiguous: 4 poses"));
  EXPECT_THAT(lines[1], testing::HasSubstr("--initial"));
}

TEST(Match, AnInitialRotationDecidesOtherwise) {
  const Faked faked = Fake(1, 1, 7);
  const Rigid3d rolled =
      Rigid3d{ExpSo3({0.0, 0.0, std::numbers::pi}), Eigen::Vector3d::Zero()} * kFakeCamFromLidar;
  const MatchSettings settings{.initial = rolled};
  const Expected<Matching> matching = MatchViews(faked.views, settings);
  ASSERT_TRUE(matching) << matching.error().message;
  // Half a turn about the board's normal, which leans against the camera's axis.
  EXPECT_GT(RotationDistance(matching->cam_from_lidar.rotation, kFakeCamFromLidar.rotation), 3.0);
  EXPECT_THAT(DescribeAmbiguity(*matching, settings)[1],
              testing::HasSubstr("the rotation of --initial"));
}

// Two equal boards in one plane fit each other's place after half a turn.
TEST(Match, TwoEqualBoardsInOnePlaneAreAmbiguous) {
  Random random(11);
  const std::vector<Board> boards = Squares(2);
  const Eigen::Quaterniond corner_up = ExpSo3({0.0, 0.0, 0.25 * std::numbers::pi});
  const std::vector<Rigid3d> poses = {{corner_up, {-0.5, 0.0, 2.0}}, {corner_up, {0.5, 0.0, 2.0}}};
  const std::vector<Observation> views = {
      FakeObservation(boards, poses, kFakeCamFromLidar, random)};
  const Expected<Matching> matching = MatchViews(views);
  ASSERT_TRUE(matching) << matching.error().message;
  EXPECT_FALSE(matching->alternatives.empty());
  EXPECT_LT(RotationDistance(matching->cam_from_lidar.rotation, kFakeCamFromLidar.rotation), 0.1);
}

TEST(Match, ARectangleLeavesHalfATurnOnly) {
  Random random(13);
  Board board = SquareBoard(0);
  board.right_bottom_m = 0.8;
  const std::vector<Board> boards = {board};
  // It nearly faces the sensors: after half a turn they are only 0.8 m apart.
  const Eigen::Quaterniond leaning = ExpSo3({0.1, 0.2, 0.0});
  const std::vector<Rigid3d> poses = {
      {leaning * ExpSo3({0.0, 0.0, 0.25 * std::numbers::pi}), {0.1, 0.0, 2.0}}};
  const std::vector<Observation> views = {
      FakeObservation(boards, poses, kFakeCamFromLidar, random)};
  const Expected<Matching> matching = MatchViews(views);
  ASSERT_TRUE(matching) << matching.error().message;
  EXPECT_EQ(matching->alternatives.size(), 1U);
}

TEST(Match, ATagThatMayLeanEitherWayIsSettledByTheOtherViews) {
  Faked faked = Fake(4, 1, 17);
  CameraSighting& sighting = faked.views[1].in_image[0];
  // The image takes the wrong way for the likelier one.
  const Rigid3d truth = sighting.pose.cam_from_board;
  Rigid3d wrong = truth;
  wrong.rotation = truth.rotation * ExpSo3({0.5, 0.2, 0.0});
  sighting.pose.cam_from_board = wrong;
  sighting.pose.ambiguous_with = truth;
  sighting.pose.ambiguity_chi_square = 3.0;
  sighting.other_corners = sighting.corners.points;
  sighting.corners.points.clear();
  for (const Eigen::Vector3d& corner : BoardCorners(faked.boards[0])) {
    sighting.corners.points.push_back(wrong * corner);
  }
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_TRUE(matching) << matching.error().message;
  ASSERT_EQ(matching->kept.size(), 4U);
  for (const MatchedBoard& kept : matching->kept) EXPECT_EQ(kept.other_pose, kept.view == 1);
}

TEST(Match, TwoViewsThatContradictEachOtherLeaveOneOut) {
  Faked faked = Fake(2, 1, 19);
  Random random(21);
  Rigid3d after = faked.views[1].in_image[0].pose.cam_from_board;
  after.translation.x() += 0.4;
  faked.views[1].in_image =
      FakeObservation(faked.boards, std::vector<Rigid3d>{after}, kFakeCamFromLidar, random)
          .in_image;
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_TRUE(matching) << matching.error().message;
  EXPECT_EQ(matching->kept.size(), 1U);
  EXPECT_EQ(matching->dropped.size(), 1U);
  EXPECT_FALSE(matching->alternatives.empty());
}

// The patch is as far from the LiDAR as the image shows the board from the camera, give or take the
// distance of the sensors, or it is another object.
TEST(Match, APatchFarFromWhereTheImageShowsTheBoardIsNotUsed) {
  Faked faked = Fake(1, 1, 29);
  Random random(31);
  Rigid3d beyond = faked.views[0].in_image[0].pose.cam_from_board;
  beyond.translation *= 2.5;
  faked.views[0].in_scan =
      FakeObservation(faked.boards, std::vector<Rigid3d>{beyond}, kFakeCamFromLidar, random)
          .in_scan;
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_FALSE(matching);
  EXPECT_EQ(matching.error().code, ErrorCode::kTooFewPairs);
  const auto why = WhyNoneIsSameBoard(faked.views[0], 0, 2.0);
  ASSERT_TRUE(why);
  EXPECT_THAT(*why, testing::ContainsRegex("the photo shows the board .* m away, the scan's "
                                           "candidate is .* m away"));
  // Sensors that are stated to be that far apart may see it so.
  const MatchSettings settings{.initial = Rigid3d{AxesCamFromLidar().rotation, {0.0, 0.0, 4.0}}};
  EXPECT_TRUE(MatchViews(faked.views, settings));
}

TEST(Match, APatchThatFacesElsewhereIsNotUsed) {
  Faked faked = Fake(1, 1, 33);
  Random random(35);
  Rigid3d turned = faked.views[0].in_image[0].pose.cam_from_board;
  turned.rotation = ExpSo3({0.0, 1.2, 0.0}) * turned.rotation;
  faked.views[0].in_scan =
      FakeObservation(faked.boards, std::vector<Rigid3d>{turned}, kFakeCamFromLidar, random)
          .in_scan;
  EXPECT_FALSE(MatchViews(faked.views));
  EXPECT_THAT(*WhyNoneIsSameBoard(faked.views[0], 0, 2.0),
              testing::HasSubstr("the sensors would be"));
}

// With several patches in a scan, the one where the image shows the board is used. The others are
// not at one distance from it in all views: that would be another pose of the LiDAR.
TEST(Match, OfTwoPatchesTheOneWhereTheImageShowsTheBoardIsUsed) {
  Faked faked = Fake(4, 1, 37);
  Random random(39);
  for (Observation& view : faked.views) {
    Rigid3d other = view.in_image[0].pose.cam_from_board;
    other.translation += Eigen::Vector3d(random.Uniform(-1.5, 1.5), 0.0, 0.8);
    const Observation ghost =
        FakeObservation(faked.boards, std::vector<Rigid3d>{other}, kFakeCamFromLidar, random);
    view.in_scan.insert(view.in_scan.begin(), ghost.in_scan[0]);
  }
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_TRUE(matching) << matching.error().message;
  ASSERT_EQ(matching->kept.size(), 4U);
  for (const MatchedBoard& kept : matching->kept) EXPECT_EQ(kept.patch, 1);
}

// Sessions: a pose needs most of the views.
std::vector<SessionView> SessionOf(const Faked& faked) {
  std::vector<SessionView> views;
  for (const Observation& seen : faked.views) {
    views.push_back({.name = std::to_string(views.size()), .seen = seen});
  }
  return views;
}

TEST(Assemble, GivesNoPoseWhereMostScansLackTheBoard) {
  Faked faked = Fake(5, 1, 41);
  EXPECT_TRUE(Assemble(SessionOf(faked), faked.boards, FakeCamera()));
  for (std::size_t i = 0; i < 3; ++i) {
    faked.views[i].in_scan.clear();
    faked.views[i].missing.push_back({.why = "no board"});
  }
  const Expected<Assembly> assembly = Assemble(SessionOf(faked), faked.boards, FakeCamera());
  ASSERT_FALSE(assembly);
  EXPECT_EQ(assembly.error().code, ErrorCode::kMissingData);
  EXPECT_THAT(assembly.error().message, testing::HasSubstr("of 5 views whose photo shows a board, "
                                                           "the scan agrees in 2, disagrees in 0 "
                                                           "and shows no board in 3"));
}

TEST(Assemble, GivesNoPoseWhereTwoViewsContradictEachOther) {
  Faked faked = Fake(2, 1, 19);
  Random random(21);
  Rigid3d after = faked.views[1].in_image[0].pose.cam_from_board;
  after.translation.x() += 0.4;
  faked.views[1].in_image =
      FakeObservation(faked.boards, std::vector<Rigid3d>{after}, kFakeCamFromLidar, random)
          .in_image;
  EXPECT_FALSE(Assemble(SessionOf(faked), faked.boards, FakeCamera()));
}

TEST(Match, NothingInCommonIsAnError) {
  Faked faked = Fake(2, 1, 23);
  faked.views[0].in_image.clear();
  faked.views[1].in_scan.clear();
  const Expected<Matching> matching = MatchViews(faked.views);
  ASSERT_FALSE(matching);
  EXPECT_EQ(matching.error().code, ErrorCode::kTooFewPairs);
}

}  // namespace
}  // namespace sextant::test
