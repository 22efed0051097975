// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/scene_observer.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <sstream>

#include "base/units.h"
#include "calibrate/observe/board_scale.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/random_vectors.h"
#include "geometry/scan_marks.h"
#include "io/text/number_text.h"
#include "simulator/scene/camera_model.h"
#include "simulator/scene/scene_file.h"
#include "simulator/scene/scene_truth.h"
#include "simulator/session/validate_scene.h"
#include "solvers/kernels/cloud_sums.h"

namespace sextant {
namespace {

// Parses a list parameter such as "0.1 -2 3" with `count` numbers; errors name the parameter.
Expected<std::vector<double>> ParseNumbers(const std::string& name, const std::string& text,
                                           std::size_t count) {
  std::istringstream words(text);
  std::vector<double> numbers;
  for (std::string word; words >> word;) {
    SEXTANT_ASSIGN_OR_RETURN(const double number, ParseFinite(word, {.file = name}));
    numbers.push_back(number);
  }
  if (numbers.size() == count) return numbers;
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("option {}={}: expected {} numbers", name, text, count));
}

// cam_from_lidar of the scene, overridden by the settings.
Expected<Rigid3d> ExtrinsicOf(const SceneSettings& settings, const Rigid3d& of_scene) {
  Rigid3d cam_from_lidar = of_scene;
  if (!settings.translation_m.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const auto xyz,
                             ParseNumbers("translation_m", settings.translation_m, 3));
    cam_from_lidar.translation = {xyz[0], xyz[1], xyz[2]};
  }
  if (!settings.rotation_deg.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const auto angles,
                             ParseNumbers("rotation_deg", settings.rotation_deg, 3));
    const Eigen::Quaterniond turn = FromEulerZyx({.yaw = kRadPerDeg * angles[0],
                                                  .pitch = kRadPerDeg * angles[1],
                                                  .roll = kRadPerDeg * angles[2]});
    cam_from_lidar.rotation = (turn * AxesCamFromLidar().rotation).normalized();
  }
  return cam_from_lidar;
}

Expected<Camera> SolverCamera(const SceneSettings& settings, const Camera& true_camera) {
  Camera assumed = true_camera;
  if (!settings.assumed_intrinsics.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const auto numbers,
                             ParseNumbers("assumed_intrinsics", settings.assumed_intrinsics, 4));
    assumed.fx_px = numbers[0];
    assumed.fy_px = numbers[1];
    assumed.cx_px = numbers[2];
    assumed.cy_px = numbers[3];
  }
  assumed.fx_px *= 1.0 + settings.assumed_focal_error;
  assumed.fy_px *= 1.0 + settings.assumed_focal_error;
  if (!settings.assumed_distortion) {
    assumed.model = CameraModel::kPinhole;
    assumed.distortion.fill(0.0);
  }
  SEXTANT_RETURN_IF_ERROR(ValidateCamera(assumed));
  return assumed;
}

}  // namespace

Expected<SceneObserver> SceneObserver::Make(const SceneSettings& settings,
                                            const std::filesystem::path& folder, int camera) {
  SceneObserver observer;
  observer.settings_ = settings;
  observer.camera_index_ = camera;
  SEXTANT_ASSIGN_OR_RETURN(observer.scene_, ReadScene(folder / settings.scene));
  for (SceneBoard& board : observer.scene_.boards) {
    ScaleOutline(settings.board_scale, board.board);
    ScalePrint(settings.board_scale, board.board);
  }
  if (!settings.lidar_model.empty()) observer.scene_.lidar.model = settings.lidar_model;
  if (static_cast<int>(observer.scene_.cameras.size()) <= camera) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{}: expected {} or more cameras", settings.scene, camera + 1));
  }
  SceneCamera& scene_camera = observer.scene_.cameras[static_cast<std::size_t>(camera)];
  if (!settings.camera_model.empty()) scene_camera.model = settings.camera_model;
  SEXTANT_ASSIGN_OR_RETURN(observer.cam_from_lidar_,
                           ExtrinsicOf(settings, CamFromLidar(observer.scene_, scene_camera)));
  scene_camera.world_from_cam =
      observer.scene_.lidar.world_from_lidar * observer.cam_from_lidar_.Inverse();
  if (const Expected<void> ok = ValidateScene(observer.scene_); !ok) {
    return MakeError(ok.error().code, settings.scene + ": " + ok.error().message);
  }
  observer.camera_ = *RenderingCamera(scene_camera);
  observer.whole_scene_ = observer.scene_;
  std::erase_if(observer.scene_.boards,
                [&observer](const SceneBoard& board) { return !observer.CanFind(board); });
  if (observer.scene_.boards.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{}: camera {} cannot find any board", settings.scene, camera));
  }
  SEXTANT_ASSIGN_OR_RETURN(observer.assumed_camera_,
                           SolverCamera(settings, *PublishedCamera(scene_camera)));
  observer.lidar_ = *FindLidarModel(observer.scene_.lidar.model);
  if (const auto known = ExtractCorners(settings.extractor, {}, {});
      !known && known.error().code == ErrorCode::kUnknownName) {
    return tl::unexpected<Error>(known.error());
  }
  if (settings.camera == CameraObservation::kRendered) {
    SEXTANT_ASSIGN_OR_RETURN(
        BoardFinder finder, BoardFinder::Make(BoardsIn(observer.scene_), observer.assumed_camera_));
    observer.finder_ = std::make_shared<const BoardFinder>(std::move(finder));
  }
  return observer;
}

Scene SceneObserver::PlaceBoardsInRoom(std::uint64_t seed) const {
  Scene scene = scene_;
  // The purpose "hang" is part of the seeds of all recorded figures.
  Random random(DeriveSeed(seed, "hang", 0, 0));
  for (SceneBoard& board : scene.boards) {
    Vector6d delta;
    for (int i = 0; i < 6; ++i) {
      const double most = i < 3 ? kRadPerDeg * settings_.placement_deg : settings_.placement_m;
      delta[i] = random.Uniform(-most, most);
    }
    board.world_from_board = Perturb(board.world_from_board, delta);
  }
  return scene;
}

Rigid3d SceneObserver::DrawStart(std::uint64_t seed, const PointSets& sets) const {
  Random random(DeriveSeed(seed, "start", 0, 0));
  Rigid3d start = settings_.start == StartPose::kAxes ? AxesCamFromLidar() : cam_from_lidar_;
  const Eigen::Vector3d axis = NormalVector(random).normalized();
  const Eigen::Vector3d shift = settings_.start_m * NormalVector(random).normalized();
  start.rotation = (ExpSo3(kRadPerDeg * settings_.start_deg * axis) * start.rotation).normalized();
  if (settings_.start_centroids && !sets.in_cam.empty()) {
    start.translation = MeanOf(sets.in_cam) - start.rotation * MeanOf(sets.in_lidar);
  }
  start.translation += shift;
  return start;
}

Expected<CalibrationProblem> SceneObserver::Observe(const Scene& scene, std::uint64_t unit_seed,
                                                    int view, double time_s) const {
  CalibrationProblem problem;
  problem.camera = assumed_camera_;
  problem.boards = BoardsIn(scene_);
  SEXTANT_ASSIGN_OR_RETURN(const auto in_lidar, ObserveWithLidar(scene, unit_seed, view, time_s));
  if (settings_.camera == CameraObservation::kMarked) {
    MarkCorners(scene, in_lidar, unit_seed, view, time_s, problem);
  } else {
    SEXTANT_ASSIGN_OR_RETURN(const auto in_cam, ObserveWithCamera(scene, unit_seed, view, time_s));
    PairCorners(in_cam, in_lidar, view, problem);
  }
  if (!problem.pairs_2d3d.empty() || !problem.pairs_3d3d.empty()) return problem;
  return MakeError(ErrorCode::kTooFewPairs,
                   settings_.scene + ": no board was found by both sensors");
}

void SceneObserver::PairCorners(const std::vector<SeenCorners>& in_cam,
                                const std::vector<SeenCorners>& in_lidar, int view,
                                CalibrationProblem& problem) const {
  const Eigen::Matrix3d rotation = cam_from_lidar_.rotation.toRotationMatrix();
  for (std::size_t b = 0; b < in_cam.size(); ++b) {
    const std::size_t corners = std::min(in_cam[b].points.size(), in_lidar[b].points.size());
    for (std::size_t i = 0; i < corners; ++i) {
      Pair3d3d pair{.point_in_cam = in_cam[b].points[i],
                    .point_in_lidar = in_lidar[b].points[i],
                    .covariance_in_cam = {},
                    .id = {view, scene_.boards[b].board.id, static_cast<int>(i)}};
      if (settings_.state_noise) {
        const auto at = 3 * static_cast<Eigen::Index>(i);
        pair.covariance_in_cam =
            in_cam[b].covariance.block<3, 3>(at, at) +
            rotation * in_lidar[b].covariance.block<3, 3>(at, at) * rotation.transpose();
      }
      problem.pairs_3d3d.push_back(std::move(pair));
    }
  }
}

}  // namespace sextant
