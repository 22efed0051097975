// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <opencv2/core.hpp>
#include <optional>

#include "simulator/camera/render.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/camera_model.h"

namespace sextant::test {
namespace {

// A tilted hollow board, a box and two walls in front of a LiDAR and a camera that are close to
// each other.
sextant::Scene SharedScene() {
  Eigen::Matrix3d axes;
  axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  const Eigen::Quaterniond world_from_view(axes);
  sextant::Scene scene;
  scene.lidar.world_from_lidar = {
      Eigen::Quaterniond(Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitZ())), {0.0, 0.05, 0.0}};
  scene.cameras = {{.model = "zed_left", .world_from_cam = {world_from_view, {0.1, 0.0, -0.1}}}};
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 0).normalized()));
  scene.boards = {{.board = {.top_right_m = 1.2,
                             .right_bottom_m = 1.0,
                             .hole = BoardHole{.width_m = 0.5, .height_m = 0.4}},
                   .world_from_board = {world_from_view * tilt, {2.5, 0.3, 0.0}}}};
  scene.walls = {{.name = "back",
                  .world_from_wall = {world_from_view, {6.0, 0.0, 0.0}},
                  .width_m = 20.0,
                  .height_m = 10.0}};
  scene.boxes = {
      {.name = "box",
       .world_from_box = {Eigen::Quaterniond(Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitZ())),
                          {3.5, -1.2, 0.0}},
       .size_m = {0.5, 0.5, 0.8}}};
  return scene;
}

struct PixelSurface {
  Eigen::Vector3d point_in_cam;
  Eigen::Vector3d normal_in_cam;
};

std::optional<PixelSurface> SurfaceAt(const Camera& camera, const SurfaceImage& surfaces,
                                      const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  if (x < 0 || y < 0 || x >= camera.width_px || y >= camera.height_px) return std::nullopt;
  const double depth = surfaces.depth_m.at<double>(y, x);
  if (depth == 0.0) return std::nullopt;
  const Eigen::Vector3d ray = *Unproject(camera, {1.0 * x, 1.0 * y});
  const auto& n = surfaces.normal_in_cam.at<cv::Vec3d>(y, x);
  return PixelSurface{ray * (depth / ray.z()), {n[0], n[1], n[2]}};
}

// Transforms the truth of one sensor to the other with the true poses: a LiDAR point lies in the
// plane of the pixel onto which it projects, unless an edge hides it from one of the sensors.
TEST(Sensors, MeasureTheSamePlanes) {
  const sextant::Scene scene = SharedScene();
  const Camera camera = *RenderingCamera(scene.cameras[0]);
  const Expected<SurfaceImage> surfaces = RenderSurfaces(scene, 0, 0.0);
  ASSERT_TRUE(surfaces);
  const auto scan = SimulateScan(scene, *FindLidarModel("vlp16"),
                                 {.noise = false,
                                  .quantisation = false,
                                  .divergence = false,
                                  .dropouts = false,
                                  .truth = true});
  ASSERT_TRUE(scan) << scan.error().message;
  const Rigid3d cam_from_lidar =
      scene.cameras[0].world_from_cam.Inverse() * scene.lidar.world_from_lidar;
  int seen = 0;
  int hidden = 0;
  int on_board = 0;
  for (std::size_t i = 0; i < scan->cloud.points.size(); ++i) {
    const Eigen::Vector3d point = cam_from_lidar * scan->cloud.points[i];
    const auto pixel = point.allFinite() ? Project(camera, point) : std::nullopt;
    const auto surface = pixel ? SurfaceAt(camera, *surfaces, *pixel) : std::nullopt;
    if (!surface) continue;
    ++seen;
    const double miss = surface->normal_in_cam.dot(point - surface->point_in_cam);
    if (std::abs(miss) > 1e-9) {
      ++hidden;
    } else if (scan->truth[i].object == SceneObject::kBoard) {
      ++on_board;
    }
  }
  EXPECT_GT(seen, 2000);
  EXPECT_GT(on_board, 300);
  // Occlusions at the borders of board, hole and box due to the baseline of 0.15 m.
  EXPECT_LT(hidden, 0.08 * seen);
}

}  // namespace
}  // namespace sextant::test
