// SPDX-License-Identifier: Apache-2.0
// One image of a simulated camera on one thread: two boards with tags in a room.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <opencv2/core.hpp>
#include <string>

#include "simulator/camera/render.h"
#include "simulator/scene/camera_model.h"

namespace sextant::bench {
namespace {

// The world frame is the camera's; walls around it and a tiled floor.
Scene Room(const std::string& camera_model) {
  Scene scene;
  scene.cameras = {{.model = camera_model}};
  const Eigen::Quaterniond diagonal(Eigen::AngleAxisd(0.25 * M_PI, Eigen::Vector3d::UnitZ()));
  for (const double x : {-0.4, 0.4}) {
    SceneBoard board{.world_from_board = {diagonal, {x, 0.0, 2.0}}};
    board.board = {.top_right_m = 0.484,
                   .right_bottom_m = 0.468,
                   .tags = {{.family = "aruco_original", .id = 26, .edge_m = 0.205}}};
    scene.boards.push_back(board);
  }
  const auto wall = [&scene](const Eigen::Vector3d& axis, double angle, const Eigen::Vector3d& at,
                             double tile_m) {
    scene.walls.push_back(
        {.name = std::to_string(scene.walls.size()),
         .world_from_wall = {Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis)), at},
         .width_m = 8.0,
         .height_m = 8.0,
         .tile_m = tile_m});
  };
  wall(Eigen::Vector3d::UnitX(), 0.0, {0, 0, 5}, 0.0);
  wall(Eigen::Vector3d::UnitX(), 0.5 * M_PI, {0, 1, 2}, 0.5);
  wall(Eigen::Vector3d::UnitX(), 0.5 * M_PI, {0, -2, 2}, 0.0);
  wall(Eigen::Vector3d::UnitY(), 0.5 * M_PI, {-4, 0, 2}, 0.0);
  wall(Eigen::Vector3d::UnitY(), 0.5 * M_PI, {4, 0, 2}, 0.0);
  return scene;
}

// Checks that points of known colour are at their projections.
bool Check(benchmark::State& state, const Scene& scene) {
  const Expected<cv::Mat> image = RenderImage(scene, 0, {.lighting = {.ambient = 1.0}});
  const Expected<Camera> camera = RenderingCamera(scene.cameras[0]);
  if (!image || !camera) {
    state.SkipWithError(image ? camera.error().message.c_str() : image.error().message.c_str());
    return false;
  }
  for (const SceneBoard& board : scene.boards) {
    // The centre of the left side of the black frame, and a point one centimetre outside.
    for (const double x_m : {-0.095, -0.115}) {
      const auto pixel = Project(*camera, board.world_from_board * Eigen::Vector3d(x_m, 0.0, 0.0));
      const double albedo = x_m < -0.1 ? board.white.albedo : board.black.albedo;
      const int level = image->at<std::uint8_t>(static_cast<int>(std::lround(pixel->y())),
                                                static_cast<int>(std::lround(pixel->x())));
      if (std::abs(level - 255.0 * albedo) <= 0.5) continue;
      state.SkipWithError("a point of the board has the wrong colour");
      return false;
    }
  }
  return true;
}

void Image(benchmark::State& state, const std::string& camera_model) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const Scene scene = Room(camera_model);
  if (!Check(state, scene)) return;
  std::uint64_t seed = 0;
  for (auto _ : state) {
    ++seed;
    benchmark::DoNotOptimize(RenderImage(scene, 0, UsualImageOptions(seed, 0.0)));
  }
}

// Items are pixels.
BENCHMARK_CAPTURE(Image, zed_left, "zed_left")
    ->Name("image/zed_left/921600")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Image, fisheye, "fisheye")
    ->Name("image/fisheye/2319360")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant::bench

BENCHMARK_MAIN();
