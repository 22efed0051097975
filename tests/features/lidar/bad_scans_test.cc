// SPDX-License-Identifier: Apache-2.0
// Scans with defects: damaged, rotated, in any order, with boards that are hidden or cut off.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "eval/extractors/board_scenes.h"
#include "features/lidar/corner_extractor.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant::test {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

// One board straight ahead, so that the edge of the field of view can cross it.
struct SeenBoard {
  Scene scene;
  std::vector<Board> boards;
  PointCloud cloud;
};

SeenBoard OneBoard(const std::vector<SceneCylinder>& obstacles = {}) {
  Random random(1);
  SeenBoard seen;
  seen.scene = TwoBoardsInRoom({}, random);
  seen.scene.boards = {PlaceBoard(seen.scene.boards[0].board, {.turn_deg = 40.0, .yaw_deg = 10.0})};
  seen.scene.cylinders = obstacles;
  seen.boards = BoardsIn(seen.scene);
  Expected<SimulatedScan> scan = SimulateScan(seen.scene, *FindLidarModel("os1_64"), {.seed = 1});
  EXPECT_TRUE(scan);
  seen.cloud = std::move(scan->cloud);
  return seen;
}

BoardSearch Search(const PointCloud& cloud, const std::vector<Board>& boards) {
  const Expected<ScanRings> rings = ScanRings::Build(cloud);
  EXPECT_TRUE(rings);
  return *FindBoards(*rings, boards, {});
}

double WorstCorner(const SeenBoard& seen, const BoardSearch& search) {
  if (search.found.empty()) return std::numeric_limits<double>::infinity();
  const Expected<LidarCorners> corners =
      ExtractCorners("rectangle", search.found[0], seen.boards[0]);
  double worst = 0.0;
  for (int i = 0; i < kCornersPerBoard; ++i) {
    const Eigen::Vector3d truth = TrueCorner(seen.scene.boards[0], i);
    worst = std::max(worst, (corners->in_lidar[static_cast<std::size_t>(i)] - truth).norm());
  }
  return worst;
}

void Keep(PointCloud& cloud, const std::vector<std::size_t>& places) {
  PointCloud kept;
  for (const std::size_t i : places) {
    kept.points.push_back(cloud.points[i]);
    if (!cloud.ring.empty()) kept.ring.push_back(cloud.ring[i]);
  }
  cloud = std::move(kept);
}

TEST(BadScans, OrderOfThePointsDoesNotMatter) {
  const SeenBoard seen = OneBoard();
  const BoardSearch swept = Search(seen.cloud, seen.boards);
  for (const bool with_rings : {true, false}) {
    PointCloud shuffled = seen.cloud;
    Random random(2);
    std::vector<std::size_t> places(shuffled.points.size());
    for (std::size_t i = 0; i < places.size(); ++i) {
      places[i] = i;
      std::swap(places[i], places[random.Below(i + 1)]);
    }
    Keep(shuffled, places);
    if (!with_rings) shuffled.ring.clear();
    const BoardSearch found = Search(shuffled, seen.boards);
    ASSERT_EQ(found.found.size(), 1U);
    EXPECT_LT(std::abs(WorstCorner(seen, found) - WorstCorner(seen, swept)), 1e-9);
  }
}

TEST(BadScans, InvalidReturnsAreOmitted) {
  SeenBoard seen = OneBoard();
  const double whole = WorstCorner(seen, Search(seen.cloud, seen.boards));
  ASSERT_LT(whole, 0.03) << "the board is found";
  const double infinity = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& bad :
       {Eigen::Vector3d(kNaN, 1.0, 1.0), Eigen::Vector3d(0.0, 0.0, 0.0),
        Eigen::Vector3d(infinity, 0.0, 0.0), Eigen::Vector3d(1e200, 1e200, 0.0)}) {
    for (int i = 0; i < 50; ++i) {
      seen.cloud.points.push_back(bad);
      seen.cloud.ring.push_back(static_cast<std::uint16_t>(i));
    }
  }
  EXPECT_EQ(WorstCorner(seen, Search(seen.cloud, seen.boards)), whole);
}

TEST(BadScans, OneRingGivesNoBoard) {
  SeenBoard seen = OneBoard();
  std::vector<std::size_t> places;
  for (std::size_t i = 0; i < seen.cloud.points.size(); ++i) {
    if (seen.cloud.ring[i] == 30) places.push_back(i);
  }
  Keep(seen.cloud, places);
  for (const bool with_rings : {true, false}) {
    if (!with_rings) seen.cloud.ring.clear();
    EXPECT_EQ(ScanRings::Build(seen.cloud)->rings(), 1);
    EXPECT_TRUE(Search(seen.cloud, seen.boards).found.empty());
  }
}

TEST(BadScans, FewPointsGiveNoBoard) {
  const SeenBoard seen = OneBoard();
  for (const std::size_t count : {1U, 2U, 7U, 40U}) {
    PointCloud few;
    few.points.assign(seen.cloud.points.begin(),
                      seen.cloud.points.begin() + static_cast<std::ptrdiff_t>(count));
    EXPECT_TRUE(Search(few, seen.boards).found.empty()) << count;
    few.points.assign(count, Eigen::Vector3d(2.0, 0.0, 0.0));
    EXPECT_TRUE(Search(few, seen.boards).found.empty()) << count;
  }
}

// A pole 0.6 m in front of the board hides a stripe of it, including parts of its edges.
TEST(BadScans, BoardBehindAPoleIsFound) {
  const SeenBoard seen = OneBoard(
      {{.name = "pole", .base_in_world = {1.2, 0.08, -1.0}, .radius_m = 0.02, .height_m = 2.5}});
  EXPECT_LT(WorstCorner(seen, Search(seen.cloud, seen.boards)), 0.015);
}

// A person hides most of the board.
TEST(BadScans, BoardBehindAPersonIsNot) {
  const SeenBoard seen = OneBoard(
      {{.name = "person", .base_in_world = {1.2, 0.0, -1.0}, .radius_m = 0.25, .height_m = 1.75}});
  EXPECT_TRUE(Search(seen.cloud, seen.boards).found.empty());
}

// The driver reports only a sector, whose limit crosses the board: the visible part is placed
// correctly; a board that is cut in half is rejected. The right corner is at -0.34 m. Rings that
// end at the limit (4, 11 and 16 of 40) give edge points that are on no side; the third of these
// cuts may leave too few others.
TEST(BadScans, BoardCutByTheFieldOfViewIsPlacedByItsVisiblePart) {
  for (const double cut_m : {-0.3, -0.25, -0.2, 0.0}) {
    SeenBoard seen = OneBoard();
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < seen.cloud.points.size(); ++i) {
      const Eigen::Vector3d& p = seen.cloud.points[i];
      if (p.y() > cut_m / 1.8 * p.x()) places.push_back(i);
    }
    Keep(seen.cloud, places);
    const BoardSearch search = Search(seen.cloud, seen.boards);
    if (cut_m == 0.0) {
      EXPECT_TRUE(search.found.empty());
      ASSERT_FALSE(search.rejected.empty());
    } else if (cut_m < -0.2 || !search.found.empty()) {
      EXPECT_LT(WorstCorner(seen, search), 0.03) << cut_m;
    } else {
      EXPECT_FALSE(search.rejected.empty()) << "neither found nor rejected";
    }
  }
}

// A mirror on the wall shows a second image of the board behind it, of the same size.
TEST(BadScans, TheReflectionOfABoardIsRejected) {
  SeenBoard seen = OneBoard();
  const double mirror_x = 5.0;
  const Eigen::Vector3d center = seen.scene.boards[0].world_from_board.translation;
  const std::size_t count = seen.cloud.points.size();
  // Rays that meet the mirror below the board and are reflected.
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector3d p = seen.cloud.points[i];
    if ((p - center).norm() > 0.4) continue;
    const Eigen::Vector3d ghost(2.0 * mirror_x - p.x(), p.y() + 2.0, p.z());
    seen.cloud.points.push_back(ghost);
    seen.cloud.ring.push_back(seen.cloud.ring[i]);
  }
  EXPECT_LT(WorstCorner(seen, Search(seen.cloud, seen.boards)), 0.015);
}

// Six lines of a rosette, numbered, are not six rings.
TEST(BadScans, RingNumbersOfARosetteAreIgnored) {
  SeenBoard seen = OneBoard();
  Expected<SimulatedScan> scan = SimulateScan(seen.scene, *FindLidarModel("livox"), {.seed = 1});
  ASSERT_TRUE(scan);
  for (std::size_t i = 0; i < scan->cloud.points.size(); ++i) {
    scan->cloud.ring.push_back(static_cast<std::uint16_t>(i % 6));
  }
  const Expected<ScanRings> rings = ScanRings::Build(scan->cloud);
  ASSERT_TRUE(rings);
  EXPECT_FALSE(rings->has_rings());
  EXPECT_LT(WorstCorner(seen, Search(scan->cloud, seen.boards)), 0.03);
}

}  // namespace
}  // namespace sextant::test
