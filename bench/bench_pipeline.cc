// SPDX-License-Identifier: Apache-2.0
// The pipeline for one decoded image and one scan of the paper's two boards on one thread:
// extraction in each sensor, matching, solving. The result is checked against the truth before
// timing.
#include <benchmark/benchmark.h>

#include <opencv2/core.hpp>

#include "calibrate/match/assemble.h"
#include "geometry/so3.h"
#include "simulator/camera/render.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/camera_model.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant {
namespace {

constexpr double kMaxError_m = 0.1;  // Two boards at 2 m in a single view.
constexpr double kMaxError_rad = 0.05;

SceneBoard PlaceBoard(int id, double y_m, double yaw_rad) {
  SceneBoard placed;
  placed.board = {.id = id, .top_right_m = 0.468, .right_bottom_m = id == 0 ? 0.484 : 0.49};
  placed.board.tags = {{.family = "aruco_original", .id = id == 0 ? 26 : 582, .edge_m = 0.205}};
  Eigen::Matrix3d facing;
  facing << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  placed.world_from_board = {
      Eigen::Quaterniond(facing) * ExpSo3({0.0, yaw_rad, 0.0}) * ExpSo3({0.0, 0.0, 0.8}),
      {2.0, y_m, 0.0}};
  return placed;
}

struct Recording {
  Scene scene;
  cv::Mat image;
  PointCloud cloud;
  std::vector<Board> boards;
  Camera camera;
  Rigid3d cam_from_lidar;
};

const Recording& TheRecording() {
  static const Recording recording = [] {
    Recording made;
    made.scene.boards = {PlaceBoard(0, 0.5, 0.3), PlaceBoard(1, -0.5, -0.2)};
    Eigen::Matrix3d forward;
    forward << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    SceneCamera camera{.name = "cam", .model = "zed_left"};
    camera.world_from_cam = {Eigen::Quaterniond(forward), {0.05, 0.12, -0.08}};
    made.scene.cameras = {camera};
    SceneWall wall{.name = "back", .width_m = 8.0, .height_m = 4.0};
    wall.world_from_wall = {Eigen::Quaterniond(forward), {4.5, 0.0, 0.5}};
    made.scene.walls = {wall};
    made.image = *RenderImage(made.scene, 0, UsualImageOptions(1, 0.0));
    made.cloud = SimulateScan(made.scene, *FindLidarModel("vlp16"), {.seed = 1})->cloud;
    for (const SceneBoard& board : made.scene.boards) made.boards.push_back(board.board);
    made.camera = *FindCameraModel("zed_left");
    made.cam_from_lidar = camera.world_from_cam.Inverse();
    return made;
  }();
  return recording;
}

Expected<SolveReport> Answer(const Recording& recording, const Observer& observer,
                             const Solver& solver) {
  std::vector<SessionView> views(1);
  views[0].seen = observer.Observe(recording.image, recording.cloud);
  SEXTANT_ASSIGN_OR_RETURN(const Assembly assembly,
                           Assemble(views, recording.boards, recording.camera));
  return solver.Solve(assembly.problem);
}

void CalibrateOnePair(benchmark::State& state) {
  cv::setNumThreads(1);
  const Recording& recording = TheRecording();
  const Observer observer = *Observer::Make(recording.boards, recording.camera);
  const SolverPtr solver = *BuiltinSolvers().Make("gnc(kabsch)");
  const Expected<SolveReport> report = Answer(recording, observer, *solver);
  if (!report) {
    state.SkipWithError(report.error().message.c_str());
    return;
  }
  const PoseDistance error = DistanceBetween(report->cam_from_lidar, recording.cam_from_lidar);
  if (error.translation_m > kMaxError_m || error.rotation_rad > kMaxError_rad) {
    state.SkipWithError("wrong result");
    return;
  }
  for (auto _ : state) benchmark::DoNotOptimize(Answer(recording, observer, *solver));
}
BENCHMARK(CalibrateOnePair)->Name("calibrate/one_pair/1")->Unit(benchmark::kMillisecond);

void FindInImageAndScan(benchmark::State& state) {
  cv::setNumThreads(1);
  const Recording& recording = TheRecording();
  const Observer observer = *Observer::Make(recording.boards, recording.camera);
  for (auto _ : state) {
    benchmark::DoNotOptimize(observer.Observe(recording.image, recording.cloud));
  }
}
BENCHMARK(FindInImageAndScan)->Name("calibrate/image_and_scan/1")->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant

BENCHMARK_MAIN();
