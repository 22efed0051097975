// SPDX-License-Identifier: Apache-2.0
// Boards at every roll, level ones among them, whichever way round their edges are described.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "base/units.h"
#include "eval/extractors/board_scenes.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/symmetric.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant::test {
namespace {

Board Plate(double width_m, double height_m) {
  return {.id = 0, .top_right_m = width_m, .right_bottom_m = height_m};
}

Scene RoomWith(const SceneBoard& board) {
  Random random(1);
  Scene scene = TwoBoardsInRoom({}, random);
  scene.boards = {board};
  return scene;
}

LidarModel QuietModel(const std::string& name) {
  LidarModel model = *FindLidarModel(name);
  model.range_sigma_m = 0.01;
  model.ring_bias_sigma_m = 0.0;
  return model;
}

ScanRings RingsInRoom(const Scene& scene, const LidarModel& model, std::uint64_t seed) {
  const Expected<SimulatedScan> scan = SimulateScan(scene, model, {.seed = seed});
  EXPECT_TRUE(scan);
  return *ScanRings::Build(scan->cloud);
}

BoardSearch SearchIn(const ScanRings& rings, const Board& described, const LidarModel& model) {
  BoardSearchOptions options;
  options.beam = *FindLidarBeam(model.name);
  return *FindBoards(rings, std::vector<Board>{described}, options);
}

BoardSearch SearchFor(const Board& described, const Scene& scene, const LidarModel& model,
                      std::uint64_t seed) {
  return SearchIn(RingsInRoom(scene, model, seed), described, model);
}

// The corners of the board in the numbering nearest to the one found: a scan does not show which of
// the placements of the outline is true.
std::vector<Eigen::Vector3d> NumberedAs(const LidarCorners& found, const SceneBoard& truth) {
  std::vector<Eigen::Vector3d> best;
  double least = std::numeric_limits<double>::infinity();
  for (int turn = 0; turn < kCornersPerBoard; ++turn) {
    std::vector<Eigen::Vector3d> corners;
    double off = 0.0;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      corners.push_back(TrueCorner(truth, (i + turn) % kCornersPerBoard));
      off += (corners.back() - found.in_lidar[static_cast<std::size_t>(i)]).squaredNorm();
    }
    if (off >= least) continue;
    least = off;
    best = std::move(corners);
  }
  return best;
}

double WorstCornerOf(const BoardSearch& search, const Board& described, const SceneBoard& truth) {
  const Expected<LidarCorners> corners = ExtractCorners("rectangle", search.found[0], described);
  EXPECT_TRUE(corners);
  const std::vector<Eigen::Vector3d> known = NumberedAs(*corners, truth);
  double worst = 0.0;
  for (std::size_t i = 0; i < known.size(); ++i) {
    worst = std::max(worst, (corners->in_lidar[i] - known[i]).norm());
  }
  return worst;
}

class EveryRoll : public testing::TestWithParam<std::string> {};

TEST_P(EveryRoll, OfAnOblongBoardInBothDescriptions) {
  const LidarModel model = QuietModel(GetParam());
  int missed = 0;
  for (int roll = 0; roll < 360; roll += 15) {
    const SceneBoard placed =
        PlaceBoard(Plate(0.6, 0.45), {.azimuth_deg = 8.0, .turn_deg = 1.0 * roll, .yaw_deg = 10.0});
    const ScanRings rings = RingsInRoom(RoomWith(placed), model, static_cast<std::uint64_t>(roll));
    for (const Board& described : {Plate(0.6, 0.45), Plate(0.45, 0.6)}) {
      const BoardSearch search = SearchIn(rings, described, model);
      EXPECT_EQ(search.found.size(), 1U)
          << roll << (search.rejected.empty() ? "" : ": " + search.rejected[0].why);
      missed += search.found.empty() ? 1 : 0;
      if (search.found.empty()) continue;
      // A level board ends anywhere between two rings, 63 mm apart at 1.8 m for the VLP-16.
      EXPECT_LT(WorstCornerOf(search, described, placed), roll % 90 == 0 ? 0.04 : 0.02) << roll;
    }
  }
  EXPECT_EQ(missed, 0);
}

TEST_P(EveryRoll, OfASquareBoard) {
  const LidarModel model = QuietModel(GetParam());
  for (int roll = 0; roll < 90; roll += 10) {
    const SceneBoard placed =
        PlaceBoard(Plate(0.5, 0.5), {.azimuth_deg = -8.0, .turn_deg = 1.0 * roll});
    const BoardSearch search =
        SearchFor(placed.board, RoomWith(placed), model, static_cast<std::uint64_t>(roll));
    ASSERT_EQ(search.found.size(), 1U) << roll;
    EXPECT_LT(WorstCornerOf(search, placed.board, placed), roll == 0 ? 0.04 : 0.02) << roll;
  }
}

INSTANTIATE_TEST_SUITE_P(Models, EveryRoll, testing::Values("vlp16", "os1_64", "livox"),
                         [](const auto& test) { return test.param; });

// The numbering with corner 0 highest is stated, among the equivalent ones.
TEST(BoardOrientation, CornerZeroIsTheHighestOfTheEquivalentOnes) {
  const LidarModel model = QuietModel("os1_64");
  for (const double roll : {40.0, 130.0, 220.0, 310.0}) {
    const SceneBoard placed = PlaceBoard(Plate(0.5, 0.5), {.turn_deg = roll});
    const BoardSearch search = SearchFor(placed.board, RoomWith(placed), model, 1);
    ASSERT_EQ(search.found.size(), 1U) << roll;
    const auto corners = ExtractCorners("rectangle", search.found[0], placed.board);
    ASSERT_TRUE(corners);
    for (std::size_t i = 1; i < 4; ++i) {
      EXPECT_GT(corners->in_lidar[0].z(), corners->in_lidar[i].z()) << roll;
    }
  }
}

// The height of a level board is known to a part of the distance of two rings, its position across
// to a few millimetres; the covariance states both.
TEST(BoardOrientation, TheCovarianceOfALevelBoardIsLargeAlongTheUnobservedDirection) {
  const LidarModel model = QuietModel("vlp16");
  double nees = 0.0;
  int boards = 0;
  for (int i = 0; i < 60; ++i) {
    Random random(DeriveSeed(4, "level", 0, static_cast<std::uint64_t>(i)));
    const double height = random.Uniform(-0.1, 0.1);
    const double distance = random.Uniform(1.7, 2.3);
    const double yaw = random.Uniform(-20.0, 20.0);
    const SceneBoard placed =
        PlaceBoard(Plate(0.6, 0.5),
                   {.distance_m = distance, .height_m = height, .turn_deg = 0.0, .yaw_deg = yaw});
    const BoardSearch search =
        SearchFor(placed.board, RoomWith(placed), model, static_cast<std::uint64_t>(i));
    ASSERT_EQ(search.found.size(), 1U) << i;
    const auto corners = ExtractCorners("rectangle", search.found[0], placed.board);
    ASSERT_TRUE(corners);
    const std::vector<Eigen::Vector3d> known = NumberedAs(*corners, placed);
    for (int corner = 0; corner < kCornersPerBoard; ++corner) {
      const Eigen::Matrix3d covariance = corners->CovarianceOf(corner);
      EXPECT_GT(covariance(2, 2), 2.0 * covariance(1, 1)) << i;
      const Eigen::Vector3d off = corners->in_lidar[static_cast<std::size_t>(corner)] -
                                  known[static_cast<std::size_t>(corner)];
      nees += SquaredMahalanobis(off, covariance) / 3.0;
    }
    ++boards;
  }
  nees /= 4.0 * boards;
  EXPECT_GT(nees, 0.6);
  EXPECT_LT(nees, 1.4);
}

// Part of the board is above the highest ring: its sides and its lower end place it.
TEST(BoardOrientation, ABoardPartlyAboveTheHighestRingIsPlacedByTheRest) {
  const LidarModel model = QuietModel("vlp16");
  for (const double turn : {0.0, 45.0}) {
    const SceneBoard placed =
        PlaceBoard(Plate(0.8, 0.8), {.distance_m = 2.0, .height_m = 0.35, .turn_deg = turn});
    const BoardSearch search = SearchFor(placed.board, RoomWith(placed), model, 1);
    ASSERT_EQ(search.found.size(), 1U) << turn;
    EXPECT_LT(WorstCornerOf(search, placed.board, placed), 0.05) << turn;
  }
}

}  // namespace
}  // namespace sextant::test
