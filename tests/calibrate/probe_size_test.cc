// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/probe_size.h"

#include <gmock/gmock.h>

#include "eval/extractors/board_scenes.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant::test {
namespace {

// For an image that shows the board that far away.
std::vector<std::string> ProbeAt(double range_m, const PointCloud& cloud, const Board& board) {
  const PhotoRange seen{.board = 0, .range_m = range_m};
  return ProbeSizes(cloud, std::vector<Board>{board}, std::vector<PhotoRange>{seen}, {});
}

TEST(ProbeSizes, ABoardOfAnotherSizeIsMeasured) {
  Random random(1);
  const Scene scene = TwoBoardsInRoom({.distance_m = 1.8}, random);
  const Expected<SimulatedScan> scan = SimulateScan(scene, *FindLidarModel("vlp16"), {.seed = 1});
  ASSERT_TRUE(scan) << scan.error().message;
  Board wrong;
  wrong.top_right_m = 0.65;
  wrong.right_bottom_m = 0.65;
  ASSERT_TRUE(
      FindBoards(*ScanRings::Build(scan->cloud), std::vector<Board>{wrong}, {})->found.empty());
  const std::vector<std::string> lines = ProbeAt(1.8, scan->cloud, wrong);
  ASSERT_EQ(lines.size(), 1U);
  EXPECT_THAT(lines[0], testing::HasSubstr("no board 0 of 0.650 x 0.650 m"));
  // 48.4 or 49.0 by 46.8 cm, to a step of the search (7 percent).
  EXPECT_THAT(lines[0], testing::ContainsRegex("one of about 0\\.(4[5-9]|5[0-2]) x "
                                               "0\\.(4[5-9]|50) m"));
  // The board of the image is elsewhere: what is here is another object.
  EXPECT_TRUE(ProbeAt(4.0, scan->cloud, wrong).empty());
}

TEST(ProbeSizes, NothingWhereThereIsNoBoard) {
  Random random(2);
  Scene scene = TwoBoardsInRoom({.distance_m = 1.8}, random);
  scene.boards.clear();
  const Expected<SimulatedScan> scan = SimulateScan(scene, *FindLidarModel("vlp16"), {.seed = 1});
  ASSERT_TRUE(scan) << scan.error().message;
  Board board;
  board.top_right_m = 0.5;
  board.right_bottom_m = 0.5;
  EXPECT_TRUE(ProbeAt(1.8, scan->cloud, board).empty());
}

}  // namespace
}  // namespace sextant::test
