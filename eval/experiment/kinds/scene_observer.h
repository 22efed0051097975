// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/random.h"
#include "eval/experiment/kinds/scene_settings.h"
#include "features/camera/find_boards.h"
#include "geometry/calibration_problem.h"
#include "simulator/lidar/lidar_model.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// Simulates what both sensors of a scene observe of its boards, with the settings of an
/// experiment. Immutable and thread-safe.
class SceneObserver {
 public:
  /// Keeps only boards that the camera can find: in its field of view and, unless corners are
  /// marked by hand, with a print. Errors: those of ReadScene and ValidateScene; kInvalidOption,
  /// kUnknownName for settings; kMissingData if no board is left.
  static Expected<SceneObserver> Make(const SceneSettings& settings,
                                      const std::filesystem::path& folder, int camera = 0);

  const Scene& scene() const { return scene_; }  ///< The scene with only the observed boards.
  /// The scene with all boards of the file.
  const Scene& whole_scene() const { return whole_scene_; }
  const SceneSettings& settings() const { return settings_; }
  const Rigid3d& cam_from_lidar() const { return cam_from_lidar_; }
  const Camera& assumed_camera() const { return assumed_camera_; }

  /// The scene with new random poses of its boards.
  Scene PlaceBoardsInRoom(std::uint64_t seed) const;

  /// Pairs observed at one time: 3D-3D for tags and images, 2D-3D for marked corners. `unit_seed`
  /// determines what is constant in a session (ring biases); `view` distinguishes its observations.
  /// A board that one of the sensors does not find has no pairs. Errors: kTooFewPairs if no board
  /// has any; those of the simulator.
  Expected<CalibrationProblem> Observe(const Scene& scene, std::uint64_t unit_seed, int view,
                                       double time_s) const;

  /// The start pose of local searches.
  Rigid3d DrawStart(std::uint64_t seed, const PointSets& sets) const;

 private:
  /// Corners of one board: all of them, or none if it was not found.
  struct SeenCorners {
    std::vector<Eigen::Vector3d> points{};
    Eigen::MatrixXd covariance{};
  };

  SceneObserver() = default;
  Expected<std::vector<SeenCorners>> ObserveWithLidar(const Scene& scene, std::uint64_t unit_seed,
                                                      int view, double time_s) const;
  Expected<std::vector<SeenCorners>> ObserveWithCamera(const Scene& scene, std::uint64_t unit_seed,
                                                       int view, double time_s) const;
  SeenCorners CornersOfTags(const SceneBoard& board, double time_s, Random& random) const;
  Expected<std::vector<SeenCorners>> CornersInImage(const Scene& scene, std::uint64_t seed,
                                                    double time_s) const;
  void MarkCorners(const Scene& scene, const std::vector<SeenCorners>& in_lidar,
                   std::uint64_t unit_seed, int view, double time_s,
                   CalibrationProblem& problem) const;
  void PairCorners(const std::vector<SeenCorners>& in_cam, const std::vector<SeenCorners>& in_lidar,
                   int view, CalibrationProblem& problem) const;
  bool CanFind(const SceneBoard& board) const;
  /// Pixel of a point of a board; none outside the image.
  std::optional<Eigen::Vector2d> PixelOf(const SceneBoard& board, double time_s,
                                         const Eigen::Vector3d& in_board) const;

  SceneSettings settings_;
  Scene scene_;
  Scene whole_scene_;
  int camera_index_ = 0;
  Rigid3d cam_from_lidar_{};
  Camera camera_{};          // The true camera.
  Camera assumed_camera_{};  // The camera that the solver assumes.
  LidarModel lidar_{};
  std::shared_ptr<const BoardFinder> finder_{};  // Only for rendered images.
};

}  // namespace sextant
