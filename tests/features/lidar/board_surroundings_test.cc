// SPDX-License-Identifier: Apache-2.0
// Boards with other objects in their plane, in front of them and behind them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "eval/extractors/board_scenes.h"
#include "features/lidar/corner_extractor.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "support/lidar_scenes.h"

namespace sextant::test {
namespace {

constexpr double kWidth_m = 0.9;
constexpr double kHeight_m = 0.6;

SceneBoard HeldPlate(double turn_deg) {
  Board board{.id = 0, .top_right_m = kWidth_m, .right_bottom_m = kHeight_m};
  return PlaceBoard(board, {.azimuth_deg = 5.0, .distance_m = 2.5, .turn_deg = turn_deg});
}

// A flat piece in the board's plane, at an offset from the board's centre in level axes.
SceneWall InPlane(const SceneBoard& board, const char* name, double right_m, double down_m,
                  double width_m, double height_m) {
  const Eigen::Vector3d away = board.world_from_board.rotation * Eigen::Vector3d::UnitZ();
  Rigid3d level = Facing(board.world_from_board.translation, away);
  return Wall(name, level * Rigid3d{Eigen::Quaterniond::Identity(), {right_m, down_m, 0.002}},
              width_m, height_m);
}

double WorstDistance(const Scene& scene, const std::string& lidar) {
  const Expected<SimulatedScan> scan = SimulateScan(scene, *FindLidarModel(lidar), {.seed = 3});
  EXPECT_TRUE(scan);
  const std::vector<Board> boards = BoardsIn(scene);
  const Expected<BoardSearch> search = FindBoards(*ScanRings::Build(scan->cloud), boards, {});
  EXPECT_EQ(search->found.size(), 1U) << (search->rejected.empty() ? "" : search->rejected[0].why);
  if (search->found.empty()) return 1.0;
  const auto corners = ExtractCorners("rectangle", search->found[0], boards[0]);
  double worst = 0.0;
  for (const Eigen::Vector3d& corner : corners->in_lidar) {
    double nearest = 1.0;
    for (int i = 0; i < kCornersPerBoard; ++i) {
      nearest = std::min(nearest, (corner - TrueCorner(scene.boards[0], i)).norm());
    }
    worst = std::max(worst, nearest);
  }
  return worst;
}

class Surroundings : public testing::TestWithParam<std::string> {
 protected:
  static Scene Room(double turn_deg) {
    Random random(1);
    Scene scene = TwoBoardsInRoom({}, random);
    scene.boards = {HeldPlate(turn_deg)};
    return scene;
  }
};

// The body of the person who holds the board reaches above it in its plane, and a stand below it.
TEST_P(Surroundings, APersonAndAStandInThePlaneOfTheBoard) {
  for (const double turn : {0.0, 20.0, 70.0}) {
    Scene scene = Room(turn);
    scene.walls.push_back(InPlane(scene.boards[0], "body", 0.05, -0.55, 0.4, 0.6));
    scene.walls.push_back(InPlane(scene.boards[0], "stand", 0.0, 0.6, 0.06, 0.8));
    EXPECT_LT(WorstDistance(scene, GetParam()), 0.05) << turn;
  }
}

TEST_P(Surroundings, AnArmBesideTheBoard) {
  Scene scene = Room(10.0);
  scene.walls.push_back(InPlane(scene.boards[0], "arm", 0.7, 0.05, 0.5, 0.1));
  EXPECT_LT(WorstDistance(scene, GetParam()), 0.05);
}

// Nothing behind the board returns a ray, and it stands on the ground.
TEST_P(Surroundings, ABoardThatStandsOnTheGroundInTheOpen) {
  Scene scene = Room(0.0);
  std::erase_if(scene.walls, [](const SceneWall& wall) { return wall.name != "floor"; });
  scene.boards[0] =
      PlaceBoard({.id = 0, .top_right_m = 0.9, .right_bottom_m = 1.2},
                 {.azimuth_deg = 5.0, .distance_m = 3.5, .height_m = -0.4, .turn_deg = 0.0});
  EXPECT_LT(WorstDistance(scene, GetParam()), 0.08);
}

TEST_P(Surroundings, ABoardNearAWall) {
  Scene scene = Room(30.0);
  const Rigid3d& pose = scene.boards[0].world_from_board;
  const Eigen::Vector3d away = pose.rotation * Eigen::Vector3d::UnitZ();
  scene.walls.push_back(Wall("near", Facing(pose.translation + 0.25 * away, away), 4.0, 3.0));
  EXPECT_LT(WorstDistance(scene, GetParam()), 0.03);
}

INSTANTIATE_TEST_SUITE_P(Models, Surroundings, testing::Values("vlp16", "os1_64"),
                         [](const auto& test) { return test.param; });

// A wall of the board's height and of twice its width is not the board.
TEST(BoardSurroundings, AWiderObjectOfTheSameHeightIsNoBoard) {
  Random random(1);
  Scene scene = TwoBoardsInRoom({}, random);
  const Board board{.id = 0, .top_right_m = kWidth_m, .right_bottom_m = kHeight_m};
  scene.boards = {PlaceBoard({.id = 0, .top_right_m = 1.4, .right_bottom_m = kHeight_m},
                             {.distance_m = 2.5, .turn_deg = 5.0})};
  for (const char* lidar : {"vlp16", "os1_64"}) {
    const Expected<SimulatedScan> scan = SimulateScan(scene, *FindLidarModel(lidar), {.seed = 3});
    ASSERT_TRUE(scan);
    const auto search = FindBoards(*ScanRings::Build(scan->cloud), std::vector<Board>{board}, {});
    EXPECT_TRUE(search->found.empty()) << lidar;
  }
}

}  // namespace
}  // namespace sextant::test
