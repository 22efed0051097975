// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_truth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

// A hollow board with a rotated tag in front of a rotated LiDAR and two cameras, one of which looks
// away.
Scene SomeScene() {
  Scene scene;
  scene.lidar.world_from_lidar = {ExpSo3({0.02, -0.03, 0.1}), {0.1, -0.2, 1.0}};
  Eigen::Matrix3d ahead;
  ahead << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond looks_ahead(ahead);
  SceneCamera camera{.name = "ahead", .model = "zed_left"};
  camera.world_from_cam = {ExpSo3({0.0, 0.05, -0.02}) * looks_ahead, {0.0, 0.1, 0.9}};
  scene.cameras.push_back(camera);
  camera.name = "away";
  camera.world_from_cam.rotation = ExpSo3({0.0, 0.0, 3.0}) * looks_ahead;
  scene.cameras.push_back(camera);
  SceneBoard board;
  board.board = {.id = 7, .top_right_m = 0.6, .right_bottom_m = 0.5};
  board.board.hole = BoardHole{.width_m = 0.2, .height_m = 0.1, .center_in_board_m = {0.1, 0.05}};
  board.board.tags = {{.family = "tag36h11",
                       .id = 3,
                       .edge_m = 0.1,
                       .center_in_board_m = {-0.2, -0.1},
                       .rotation_rad = 1.5707963267948966}};
  board.world_from_board = {looks_ahead, {2.0, 0.0, 1.0}};
  board.swing = Swing{.amplitude_rad = 0.1, .period_s = 1.0};
  scene.boards.push_back(board);
  return scene;
}

TEST(SceneTruth, CornersAgreeInAllFrames) {
  const Scene scene = SomeScene();
  const std::vector<BoardTruth> boards = BoardsAt(scene, 0.2);
  ASSERT_EQ(boards.size(), 1U);
  ASSERT_EQ(boards[0].corners.size(), 8U);
  const Camera camera = *RenderingCamera(scene.cameras[0]);
  const Rigid3d cam_from_lidar = CamFromLidar(scene, scene.cameras[0]);
  for (const CornerTruth& corner : boards[0].corners) {
    EXPECT_LT((scene.lidar.world_from_lidar * corner.in_lidar - corner.in_world).norm(), 1e-12);
    EXPECT_LT((cam_from_lidar * corner.in_lidar - corner.in_cam[0]).norm(), 1e-12);
    ASSERT_TRUE(corner.pixel[0]);
    EXPECT_LT((*corner.pixel[0] - *Project(camera, corner.in_cam[0])).norm(), 1e-12);
    EXPECT_FALSE(corner.pixel[1]);
  }
}

TEST(SceneTruth, CornersFollowTheSwing) {
  const Scene scene = SomeScene();
  const BoardTruth still = BoardsAt(scene, 0.0).at(0);
  const BoardTruth swung = BoardsAt(scene, 0.25).at(0);
  // Corner 0 is the pivot.
  EXPECT_LT((swung.corners[0].in_world - still.corners[0].in_world).norm(), 1e-12);
  const Eigen::Vector3d before = still.corners[3].in_world - still.corners[0].in_world;
  const Eigen::Vector3d after = swung.corners[3].in_world - swung.corners[0].in_world;
  EXPECT_NEAR(std::acos(before.normalized().dot(after.normalized())), 0.1, 1e-9);
  EXPECT_NEAR(before.norm(), 0.5, 1e-12);
}

TEST(SceneTruth, HolesAndTagsMoveWithTheirBoard) {
  const BoardTruth board = BoardsAt(SomeScene(), 0.0).at(0);
  const auto in_board = [&](const CornerTruth& corner) -> Eigen::Vector3d {
    return board.world_from_board.Inverse() * corner.in_world;
  };
  EXPECT_LT((in_board(board.corners[4]) - Eigen::Vector3d(0.0, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_LT((in_board(board.corners[6]) - Eigen::Vector3d(0.2, 0.1, 0.0)).norm(), 1e-12);
  ASSERT_EQ(board.tags.size(), 1U);
  // Rotated clockwise by 90 degrees, the tag's own top-left corner is at the right.
  EXPECT_LT((in_board(board.tags[0].corners[0]) - Eigen::Vector3d(-0.15, -0.15, 0.0)).norm(),
            1e-12);
}

}  // namespace
}  // namespace sextant
