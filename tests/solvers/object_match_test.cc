// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/object_match.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>
#include <string_view>

#include "base/random.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

constexpr double kSide_m = 0.5;
constexpr double kSigma_m = 0.008;
constexpr double kCap = 16.0 * 12.0;

using Points = std::vector<Eigen::Vector3d>;

Eigen::Vector3d Noise(Random& random, double sigma) {
  const double x = random.Normal();
  const double y = random.Normal();
  const double z = random.Normal();
  return sigma * Eigen::Vector3d(x, y, z);
}

// Corners of a square board at a random pose in front of a sensor at the origin of a.
Points Square(Random& random) {
  const Eigen::Vector3d turn = Noise(random, 0.5);
  const double x = random.Uniform(1.5, 3.0);
  const double y = random.Uniform(-1.0, 1.0);
  const double z = random.Uniform(-0.5, 0.5);
  const Rigid3d a_from_board{ExpSo3(turn), {x, y, z}};
  const double half = 0.5 * kSide_m;
  Points corners;
  for (const auto& [u, v] :
       {std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1)}) {
    corners.push_back(a_from_board * Eigen::Vector3d(0.0, u * half, v * half));
  }
  return corners;
}

Points Mapped(const Rigid3d& pose, const Points& points, Random& random) {
  Points mapped;
  for (const Eigen::Vector3d& point : points) {
    mapped.push_back(pose * point + Noise(random, kSigma_m));
  }
  return mapped;
}

Points From(const Points& corners, int first) {
  Points turned;
  for (int i = 0; i < 4; ++i) turned.push_back(corners[static_cast<std::size_t>((first + i) % 4)]);
  return turned;
}

struct MatchedSession {
  Rigid3d b_from_a;
  std::vector<MatchView> views;
  std::vector<std::set<std::size_t>> truth;  // True pairings of each view.
};

// Every board of a view paired with every other, from every corner: 4 n^2 pairings of which n are
// true.
MatchView ViewOf(const std::vector<Points>& in_b, const std::vector<Points>& in_a) {
  MatchView view;
  for (std::size_t b = 0; b < in_b.size(); ++b) {
    for (std::size_t a = 0; a < in_a.size(); ++a) {
      for (int first = 0; first < 4; ++first) {
        view.pairings.push_back({.in_b = static_cast<int>(b),
                                 .in_a = static_cast<int>(a),
                                 .points_in_b = in_b[b],
                                 .points_in_a = From(in_a[a], first),
                                 .sigma_m = kSigma_m});
      }
    }
  }
  return view;
}

MatchedSession MakeMatchedSession(int views, std::size_t boards, Random& random) {
  MatchedSession session;
  const Eigen::Vector3d turn = Noise(random, 1.5);
  session.b_from_a = {ExpSo3(turn), Noise(random, 0.3)};
  for (int v = 0; v < views; ++v) {
    std::vector<Points> in_a;
    std::vector<Points> in_b;
    std::set<std::size_t> truth;
    const std::size_t shift = random.Below(boards);
    for (std::size_t i = 0; i < boards; ++i) in_a.push_back(Square(random));
    for (std::size_t i = 0; i < boards; ++i) {
      const std::size_t a = (i + shift) % boards;
      const int first = static_cast<int>(random.Below(4));
      in_b.push_back(Mapped(session.b_from_a, From(in_a[a], first), random));
      truth.insert(4 * (boards * i + a) + static_cast<std::size_t>(first));
    }
    session.views.push_back(ViewOf(in_b, in_a));
    session.truth.push_back(truth);
  }
  return session;
}

// Number of true pairings that the explanation accepts, and whether it accepts any other.
void ExpectTruth(const MatchedSession& session, const MatchExplanation& found,
                 std::size_t wrong_views) {
  std::vector<std::set<std::size_t>> fits(session.views.size());
  for (const TakenPairing& taken : found.taken) {
    if (taken.fits) fits[taken.view].insert(taken.pairing);
  }
  for (std::size_t v = 0; v < session.views.size(); ++v) {
    if (v < wrong_views) {
      EXPECT_TRUE(fits[v].empty()) << "view " << v;
    } else {
      EXPECT_EQ(fits[v], session.truth[v]) << "view " << v;
    }
  }
}

class ManySessions : public testing::TestWithParam<int> {
 protected:
  Random MakeRandom(std::string_view name) const {
    return Random(DeriveSeed(1, name, 0, static_cast<std::uint64_t>(GetParam())));
  }
};
INSTANTIATE_TEST_SUITE_P(Seeds, ManySessions, testing::Range(0, 20));

TEST_P(ManySessions, OneSquareBoardPerView) {
  Random random = MakeRandom("one square");
  const MatchedSession session = MakeMatchedSession(4, 1, random);
  const auto found = MatchObjects(session.views, {.cap = kCap});
  ASSERT_TRUE(found) << found.error().message;
  ExpectTruth(session, found->front(), 0);
  const PoseDistance off = DistanceBetween(found->front().b_from_a, session.b_from_a);
  EXPECT_LT(off.translation_m, 0.05);
  ASSERT_GT(found->size(), 1U);
  EXPECT_GT((*found)[1].cost - (*found)[0].cost, 9.2);
}

TEST_P(ManySessions, ThreeEqualBoardsInAnyOrder) {
  Random random = MakeRandom("three squares");
  const MatchedSession session = MakeMatchedSession(2, 3, random);
  const auto found = MatchObjects(session.views, {.cap = kCap});
  ASSERT_TRUE(found) << found.error().message;
  ExpectTruth(session, found->front(), 0);
}

TEST_P(ManySessions, AThirdOfTheViewsWrong) {
  Random random = MakeRandom("wrong views");
  MatchedSession session = MakeMatchedSession(9, 1, random);
  for (std::size_t v = 0; v < 3; ++v) {
    const Points moved = Square(random);
    for (ObjectPairing& pairing : session.views[v].pairings) {
      pairing.points_in_b = Mapped(session.b_from_a, moved, random);
    }
  }
  const auto found = MatchObjects(session.views, {.cap = kCap});
  ASSERT_TRUE(found) << found.error().message;
  ExpectTruth(session, found->front(), 3);
  EXPECT_NEAR(found->front().cost, 6 * kCap + 6 * 12 - 6, 60.0);
}

TEST(ObjectMatch, OneSquareBoardHasFourExplanations) {
  Random random(2);
  const MatchedSession session = MakeMatchedSession(1, 1, random);
  const auto found = MatchObjects(session.views, {.cap = kCap});
  ASSERT_TRUE(found) << found.error().message;
  ASSERT_EQ(found->size(), 4U);
  EXPECT_LT(found->back().cost - found->front().cost, 9.2);
  for (std::size_t i = 1; i < 4; ++i) {
    const double turn =
        RotationDistance((*found)[i].b_from_a.rotation, (*found)[0].b_from_a.rotation);
    const double quarters = turn / (0.5 * std::numbers::pi);
    EXPECT_NEAR(quarters, std::round(quarters), 0.05);
    EXPECT_GT(quarters, 0.5);
  }
}

TEST(ObjectMatch, PenaltiesOfPairingsCount) {
  Random random(3);
  MatchedSession session = MakeMatchedSession(1, 1, random);
  for (std::size_t i = 0; i < 4; ++i) session.views[0].pairings[i].penalty = i == 2 ? 0.0 : 30.0;
  const auto found = MatchObjects(session.views, {.cap = kCap});
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_EQ(found->front().taken.front().pairing, 2U);
  EXPECT_GT((*found)[1].cost - (*found)[0].cost, 9.2);
}

TEST(ObjectMatch, ManyViewsNeedNotAllBeStarts) {
  Random random(4);
  const MatchedSession session = MakeMatchedSession(100, 2, random);
  const auto found = MatchObjects(session.views, {.cap = kCap, .max_starts = 64});
  ASSERT_TRUE(found) << found.error().message;
  ExpectTruth(session, found->front(), 0);
}

TEST(ObjectMatch, ReportsThatNothingIsInCommon) {
  const std::vector<MatchView> views(3);
  const auto found = MatchObjects(views);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kTooFewPairs);
}

TEST(ObjectMatch, PointsOnALineAreDegenerate) {
  const Points line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<MatchView> views = {{.pairings = {{.points_in_b = line, .points_in_a = line}}}};
  const auto found = MatchObjects(views);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::kDegenerate);
}

}  // namespace
}  // namespace sextant
