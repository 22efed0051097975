// SPDX-License-Identifier: Apache-2.0
#include "support/calibration_scene.h"

#include <gtest/gtest.h>

#include <numbers>

#include "eval/extractors/board_scenes.h"
#include "geometry/so3.h"
#include "simulator/camera/render.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"

namespace sextant::test {

Scene TaggedBoards(Random& random) {
  Scene scene = TwoBoardsInRoom({.distance_m = 2.0}, random);
  for (SceneBoard& placed : scene.boards) {
    placed.board.tags = {{.family = "aruco_original",
                          .id = placed.board.id == 0 ? 26 : 582,
                          .edge_m = 0.205,
                          .center_in_board_m = {-0.08, 0.1},
                          .rotation_rad = 0.5 * std::numbers::pi}};
  }
  SceneCamera camera{.name = "cam", .model = "zed_left"};
  Eigen::Matrix3d forward;
  forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  camera.world_from_cam = {ExpSo3(Eigen::Vector3d(0.02, -0.03, 0.04)) * Eigen::Quaterniond(forward),
                           Eigen::Vector3d(0.05, 0.12, -0.08)};
  scene.cameras = {camera};
  return scene;
}

Rigid3d TrueCamFromLidar(const Scene& scene) {
  return scene.cameras[0].world_from_cam.Inverse() * scene.lidar.world_from_lidar;
}

SensorData Record(const Scene& scene, std::uint64_t seed) {
  const Expected<SimulatedScan> scan = SimulateScan(
      scene, *FindLidarModel(scene.lidar.model), {.seed = 1, .scan_index = static_cast<int>(seed)});
  const Expected<cv::Mat> image = RenderImage(scene, 0, UsualImageOptions(seed, 0.0));
  if (!scan || !image) {
    ADD_FAILURE() << (scan ? image.error().message : scan.error().message);
    return {};
  }
  return {.image = *image, .cloud = scan->cloud};
}

}  // namespace sextant::test
