// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/session_simulation.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "base/units.h"
#include "geometry/random_vectors.h"
#include "geometry/scan_marks.h"
#include "simulator/camera/render.h"
#include "simulator/lidar/scan.h"
#include "simulator/scene/camera_model.h"
#include "simulator/scene/scene_file.h"
#include "simulator/scene/scene_pose.h"
#include "simulator/scene/scene_truth.h"
#include "simulator/session/scene_visibility.h"
#include "simulator/session/validate_scene.h"

namespace sextant {
namespace {

constexpr double kSessionStep_s = 10.0;

Eigen::Vector3d RandomDirection(Random& random) { return NormalVector(random).normalized(); }

// A plate beside the room's middle, where both sensors see it.
SceneBoard FalseBoard(const SceneBoard& board) {
  SceneBoard plate = board;
  plate.board.id = board.board.id + 1;
  plate.board.tags.clear();
  plate.board.checker.reset();
  plate.world_from_board = {
      SceneRotation(SceneAxes::kForwardIsZ, {-20.0 * kRadPerDeg, 0.0, 45.0 * kRadPerDeg}),
      {3.2, -0.9, 0.8}};
  return plate;
}

Rigid3d ShiftedAndTurned(const Rigid3d& pose, double shift_m, double turn_rad, Random& random) {
  const Eigen::Vector3d axis = RandomDirection(random);
  const Eigen::Vector3d way = RandomDirection(random);
  return {(ExpSo3(turn_rad * axis) * pose.rotation).normalized(), pose.translation + shift_m * way};
}

}  // namespace

Expected<SessionSimulator> SessionSimulator::Make(const SessionSettings& settings,
                                                  const std::filesystem::path& folder) {
  SessionSimulator simulator;
  simulator.settings_ = settings;
  Scene& scene = simulator.scene_;
  SEXTANT_ASSIGN_OR_RETURN(scene, ReadScene(folder / settings.scene));
  if (scene.boards.empty() || scene.cameras.empty()) {
    return MakeError(ErrorCode::kInvalidInput,
                     settings.scene + ": expected a board and a camera to record");
  }
  scene.boards.resize(1);
  scene.cameras.resize(1);
  if (!settings.lidar_model.empty()) scene.lidar.model = settings.lidar_model;
  SEXTANT_ASSIGN_OR_RETURN(simulator.lidar_, FindLidarModel(scene.lidar.model));
  SEXTANT_ASSIGN_OR_RETURN(simulator.camera_, RenderingCamera(scene.cameras[0]));
  if (settings.fault == SessionFault::kFalseBoard) {
    scene.boards.push_back(FalseBoard(scene.boards[0]));
  }
  if (settings.farthest_m < settings.nearest_m) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("farthest_m = {} is below nearest_m = {}", settings.farthest_m,
                                 settings.nearest_m));
  }
  Random random(1);
  SEXTANT_RETURN_IF_ERROR(simulator.PlaceBoard(random).map([](const Scene&) {}));
  return simulator;
}

bool SessionSimulator::SeenByBoth(const Scene& scene) const {
  constexpr double kMargin_px = 10.0;
  const Rigid3d cam_from_world = scene.cameras[0].world_from_cam.Inverse();
  const Rigid3d lidar_from_world = scene.lidar.world_from_lidar.Inverse();
  for (int i = 0; i < kCornersPerBoard; ++i) {
    const Eigen::Vector3d corner = TrueCorner(scene.boards[0], i);
    const std::optional<Eigen::Vector2d> pixel = Project(camera_, cam_from_world * corner);
    if (!pixel || pixel->minCoeff() < kMargin_px ||
        pixel->x() > camera_.width_px - 1.0 - kMargin_px ||
        pixel->y() > camera_.height_px - 1.0 - kMargin_px) {
      return false;
    }
    if (!IsReached(lidar_from_world * corner, lidar_)) return false;
  }
  return true;
}

Expected<Scene> SessionSimulator::PlaceBoard(Random& random) const {
  constexpr int kMaxDraws = 2000;
  Scene scene = scene_;
  Rigid3d& pose = scene.boards[0].world_from_board;
  const Rigid3d& world_from_cam = scene.cameras[0].world_from_cam;
  for (int i = 0; i < kMaxDraws; ++i) {
    const double u = random.Uniform(0.0, camera_.width_px);
    const double v = random.Uniform(0.0, camera_.height_px);
    const double distance = random.Uniform(settings_.nearest_m, settings_.farthest_m);
    const double yaw = random.Uniform(-settings_.yaw_deg, settings_.yaw_deg);
    const double pitch = random.Uniform(-settings_.pitch_deg, settings_.pitch_deg);
    const double roll =
        settings_.roll_deg + random.Uniform(-settings_.roll_spread_deg, settings_.roll_spread_deg);
    const std::optional<Eigen::Vector3d> sight = Unproject(camera_, {u, v});
    if (!sight) continue;
    const Eigen::Vector3d way = world_from_cam.rotation * sight->normalized();
    const double azimuth = std::atan2(way.y(), way.x());
    pose.translation = world_from_cam.translation + distance * way;
    pose.rotation = SceneRotation(SceneAxes::kForwardIsZ, {azimuth + kRadPerDeg * yaw,
                                                           kRadPerDeg * pitch, kRadPerDeg * roll});
    if (SeenByBoth(scene) && ValidateScene(scene)) return scene;
  }
  return MakeError(
      ErrorCode::kInvalidOption,
      fmt::format("{}: found no place between nearest_m = {} and farthest_m = {} in which the "
                  "camera and the LiDAR {} see the whole board; change the distances or the scene",
                  settings_.scene, settings_.nearest_m, settings_.farthest_m, lidar_.name));
}

void SessionSimulator::MoveCamera(std::uint64_t seed, Scene& scene) const {
  constexpr double kMoved_m = 0.03;
  constexpr double kTurned_rad = 1.0 * kRadPerDeg;
  Random random(DeriveSeed(seed, "camera", 0, 0));
  Rigid3d& pose = scene.cameras[0].world_from_cam;
  pose = ShiftedAndTurned(pose, kMoved_m, kTurned_rad, random);
}

Expected<cv::Mat> SessionSimulator::TakePhoto(Scene scene, std::uint64_t seed, int view) const {
  constexpr double kMoved_m = 0.04;
  constexpr double kTurned_rad = 2.0 * kRadPerDeg;
  const auto number = static_cast<std::uint64_t>(view);
  if (settings_.fault == SessionFault::kUnsynchronised) {
    Random random(DeriveSeed(seed, "motion", number, 0));
    Rigid3d& pose = scene.boards[0].world_from_board;
    pose = ShiftedAndTurned(pose, kMoved_m, kTurned_rad, random);
  }
  return RenderImage(
      scene, 0, UsualImageOptions(DeriveSeed(seed, "image", number, 0), kSessionStep_s * view));
}

Expected<PointCloud> SessionSimulator::TakeScan(const Scene& scene, std::uint64_t seed,
                                                int view) const {
  return SimulateScan(scene, lidar_,
                      {.seed = seed, .scan_index = view, .start_time_s = kSessionStep_s * view})
      .map([](SimulatedScan&& scan) { return std::move(scan.cloud); });
}

Expected<RecordedSession> SessionSimulator::Record(std::uint64_t seed) const {
  RecordedSession session;
  session.board = StatedBoard(scene_.boards[0].board, settings_.fault);
  session.camera = StatedCamera(camera_, settings_.fault);
  Random random(DeriveSeed(seed, "places", 0, 0));
  for (int view = 0; view < settings_.views; ++view) {
    SEXTANT_ASSIGN_OR_RETURN(Scene scene, PlaceBoard(random));
    const bool is_late = 2 * view >= settings_.views;
    if (settings_.fault == SessionFault::kSensorMoved && is_late) MoveCamera(seed, scene);
    SEXTANT_ASSIGN_OR_RETURN(cv::Mat image, TakePhoto(scene, seed, view));
    SEXTANT_ASSIGN_OR_RETURN(PointCloud scan, TakeScan(scene, seed, view));
    session.images.push_back(std::move(image));
    session.scans.push_back(std::move(scan));
    session.cam_from_lidar = CamFromLidar(scene, scene.cameras[0]);
    session.cam_from_board.push_back(scene.cameras[0].world_from_cam.Inverse() *
                                     scene.boards[0].world_from_board);
  }
  if (settings_.fault == SessionFault::kExchangedScans && settings_.views > 1) {
    std::swap(session.scans[0], session.scans[1]);
  }
  return session;
}

}  // namespace sextant
