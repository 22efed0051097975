// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "eval/experiment/kinds/session_fault.h"
#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// How a session is recorded: the first board of a scene is carried to a new place for each view.
struct SessionSettings {
  std::string scene{};        ///< Path relative to the experiment file's folder.
  std::string lidar_model{};  ///< Empty: the scene's.
  int views = 6;
  double nearest_m = 1.4;  ///< Distance of the board from the camera.
  double farthest_m = 3.0;
  double yaw_deg = 30.0;  ///< Largest turn away from the line of sight, to both sides.
  double pitch_deg = 20.0;
  double roll_deg = 45.0;  ///< In the board's plane, within roll_spread_deg of it.
  double roll_spread_deg = 10.0;
  SessionFault fault = SessionFault::kNone;
};

/// The photos and scans of a session, and what its files state.
struct RecordedSession {
  std::vector<cv::Mat> images;
  std::vector<PointCloud> scans;
  Board board;                          ///< As the board file states it.
  Camera camera;                        ///< As the camera file states it.
  Rigid3d cam_from_lidar;               ///< The truth, at the end of the session.
  std::vector<Rigid3d> cam_from_board;  ///< The truth for each photo.
};

/// Records sessions of a scene with its first camera. One unit of the LiDAR a session. Immutable
/// and thread-safe.
class SessionSimulator {
 public:
  /// Errors: those of ReadScene, FindLidarModel, RenderingCamera and ValidateScene; kInvalidInput
  /// for a scene without a board or camera; kInvalidOption for distances without a place in which
  /// both sensors see the whole board.
  static Expected<SessionSimulator> Make(const SessionSettings& settings,
                                         const std::filesystem::path& folder);

  /// The same seed gives the same bits on any number of threads. Errors: those of the simulator.
  Expected<RecordedSession> Record(std::uint64_t seed) const;

  const LidarModel& lidar() const { return lidar_; }

 private:
  SessionSimulator() = default;
  /// The scene with the board in a random place in which both sensors see all of it.
  Expected<Scene> PlaceBoard(Random& random) const;
  bool SeenByBoth(const Scene& scene) const;
  Expected<cv::Mat> TakePhoto(Scene scene, std::uint64_t seed, int view) const;
  Expected<PointCloud> TakeScan(const Scene& scene, std::uint64_t seed, int view) const;
  void MoveCamera(std::uint64_t seed, Scene& scene) const;

  SessionSettings settings_;
  Scene scene_;  // With only the first board and camera, and the false board.
  Camera camera_{};
  LidarModel lidar_{};
};

}  // namespace sextant
