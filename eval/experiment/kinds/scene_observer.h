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

/// Numbers of a list parameter: "0.1 -2 3". Error: kInvalidOption, which names it.
Expected<std::vector<double>> ParseNumbers(const std::string& name, const std::string& text,
                                           std::size_t count);

/// A unit vector of any direction; three draws.
Eigen::Vector3d RandomDirection(Random& random);

/// A scene with the settings of an experiment: what its boards look like to both sensors, again and
/// again. Immutable, thread-safe.
class SceneObserver {
 public:
  /// Of the boards only those that the camera can find: in its view and, unless corners are marked
  /// by hand, with something printed on them.
  /// Errors: those of ReadScene and ValidateScene; kInvalidOption, kUnknownName for settings;
  /// kMissingData where no board is left.
  static Expected<SceneObserver> Make(const SceneSettings& settings,
                                      const std::filesystem::path& folder, int camera = 0);

  const Scene& scene() const { return scene_; }  ///< With the boards that are looked at.
  const Scene& whole_scene() const { return whole_scene_; }  ///< With all of the file.
  const SceneSettings& settings() const { return settings_; }
  const Rigid3d& cam_from_lidar() const { return cam_from_lidar_; }
  const Camera& assumed_camera() const { return assumed_camera_; }
  std::vector<Board> Boards() const;

  /// The scene with its boards hung anew.
  Scene PlaceBoardsInRoom(std::uint64_t seed) const;

  /// Pairs of one moment: 3D-3D for tags and images, 2D-3D for marked corners. `unit_seed`: of what
  /// stays the same in a session (biases of the rings); `view` tells its moments apart.
  /// A board that one of the sensors does not find has no pairs. Errors: kTooFewPairs where none
  /// has any; those of the simulator.
  Expected<CalibrationProblem> Observe(const Scene& scene, std::uint64_t unit_seed, int view,
                                       double time_s) const;

  /// Where local searches begin.
  Rigid3d DrawStart(std::uint64_t seed, const PointSets& sets) const;

 private:
  /// Corners of one board; as many as the board has, or none where it was not found.
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
  /// Where the image has a point of a board; none outside it.
  std::optional<Eigen::Vector2d> PixelOf(const SceneBoard& board, double time_s,
                                         const Eigen::Vector3d& in_board) const;

  SceneSettings settings_;
  Scene scene_;
  Scene whole_scene_;
  int camera_index_ = 0;
  Rigid3d cam_from_lidar_{};
  Camera camera_{};          // That is.
  Camera assumed_camera_{};  // That the solver is told.
  LidarModel lidar_{};
  std::shared_ptr<const BoardFinder> finder_{};  // Of rendered images only.
};

}  // namespace sextant
