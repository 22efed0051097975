// SPDX-License-Identifier: Apache-2.0
// One revolution of a simulated LiDAR on one thread, in the paper's scene.
#include <benchmark/benchmark.h>
#include <tbb/global_control.h>

#include <cmath>
#include <string>

#include "simulator/lidar/scan.h"

namespace sextant::bench {
namespace {

// Rotation of a board that faces the origin: z along `direction`, y down as far as possible,
// rotated by `roll`.
Rigid3d Facing(const Eigen::Vector3d& position, const Eigen::Vector3d& direction, double roll_rad) {
  const Eigen::Vector3d z = direction.normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d rotation;
  rotation << x, z.cross(x), z;
  return {Eigen::Quaterniond(rotation) *
              Eigen::Quaterniond(Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ())),
          position};
}

// Two boards of 48.4 x 46.8 and 49.0 x 46.8 cm with tags of 20.5 cm, 2 m away, one corner up, in a
// room.
Scene PaperScene() {
  Scene scene;
  scene.name = "paper";
  int id = 26;
  for (const double side : {0.35, -0.35}) {
    SceneBoard board;
    board.board.top_right_m = side > 0.0 ? 0.484 : 0.490;
    board.board.right_bottom_m = 0.468;
    board.board.tags.push_back({.family = "aruco_original", .id = id, .edge_m = 0.205});
    board.world_from_board = Facing({2.0, side, 0.0}, {2.0, side, 0.0}, 0.25 * M_PI);
    scene.boards.push_back(board);
    id = 582;
  }
  const auto wall = [&scene](const Rigid3d& pose, double width_m, double height_m) {
    SceneWall made;
    made.name = "wall " + std::to_string(scene.walls.size());
    made.world_from_wall = pose;
    made.width_m = width_m;
    made.height_m = height_m;
    scene.walls.push_back(made);
  };
  wall(Facing({5, 0, 0.5}, {1, 0, 0}, 0.0), 8, 3);
  wall(Facing({-5, 0, 0.5}, {-1, 0, 0}, 0.0), 8, 3);
  wall(Facing({0, 4, 0.5}, {0, 1, 0}, 0.0), 10, 3);
  wall(Facing({0, -4, 0.5}, {0, -1, 0}, 0.0), 10, 3);
  wall({Eigen::Quaterniond::Identity(), {0, 0, -1}}, 10, 8);
  wall({Eigen::Quaterniond::Identity(), {0, 0, 2}}, 10, 8);
  return scene;
}

// Checks that noiseless points of a board lie on it, and that their number agrees with its solid
// angle.
bool Check(benchmark::State& state, const Scene& scene, const LidarModel& model) {
  const ScanOptions noiseless = {
      .noise = false, .quantisation = false, .dropouts = false, .truth = true};
  const auto scan = SimulateScan(scene, model, noiseless);
  if (!scan) {
    state.SkipWithError(scan.error().message.c_str());
    return false;
  }
  double expected = 0.0;
  for (const LidarRing& ring : model.rings) {
    // The width of a square standing on its corner, at a ring's height.
    const double half = 0.5 * std::hypot(0.487, 0.468) - std::abs(2.03 * ring.elevation_rad);
    if (half > 0.0) expected += 2.0 * 2.0 * half / 2.03 * ColumnCount(model) / (2.0 * M_PI);
  }
  int on_boards = 0;
  for (std::size_t i = 0; i < scan->truth.size(); ++i) {
    if (scan->truth[i].object != SceneObject::kBoard || scan->truth[i].spot_share < 1.0) continue;
    const SceneBoard& board = scene.boards[static_cast<std::size_t>(scan->truth[i].index)];
    const double off = (board.world_from_board.Inverse() * scan->cloud.points[i]).z();
    if (std::abs(off) > 1e-9) {
      state.SkipWithError("a noiseless point is not on its board");
      return false;
    }
    ++on_boards;
  }
  if (std::abs(on_boards / expected - 1.0) > 0.15) {
    state.SkipWithError("the number of points on the boards does not agree with their size");
    return false;
  }
  return true;
}

void Turn(benchmark::State& state, const std::string& name) {
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const Scene scene = PaperScene();
  const auto model = FindLidarModel(name);
  if (!model) return state.SkipWithError(model.error().message.c_str());
  if (!Check(state, scene, *model)) return;
  ScanOptions options;
  for (auto _ : state) {
    ++options.scan_index;
    benchmark::DoNotOptimize(SimulateScan(scene, *model, options));
  }
}

// Items are beams.
BENCHMARK_CAPTURE(Turn, vlp16, "vlp16")
    ->Name("lidar_turn/vlp16/28928")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Turn, os1_128, "os1_128")
    ->Name("lidar_turn/os1_128/131072")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant::bench

BENCHMARK_MAIN();
