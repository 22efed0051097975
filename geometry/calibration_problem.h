// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/lidar_errors.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// Where a pair was measured. Pairs of one view were taken at the same time.
struct PairId {
  int view = 0;
  int board = 0;
  int corner = 0;  ///< Number of the corner within its board; see Board.

  friend bool operator==(const PairId&, const PairId&) = default;
};

/// A point measured by both sensors.
struct Pair3d3d {
  Eigen::Vector3d point_in_cam = Eigen::Vector3d::Zero();    ///< Metres.
  Eigen::Vector3d point_in_lidar = Eigen::Vector3d::Zero();  ///< Metres.
  /// Standard deviation per axis of point_in_cam - cam_from_lidar * point_in_lidar; 0 if unknown.
  /// Either every pair of a problem states it or none does.
  double sigma_m = 0.0;
  /// Covariance [m^2] of that difference, in the camera frame; takes precedence over sigma_m.
  std::optional<Eigen::Matrix3d> covariance_in_cam;
  PairId id;
};

/// A point measured by the LiDAR and its image.
struct Pair2d3d {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  Eigen::Vector3d point_in_lidar = Eigen::Vector3d::Zero();  ///< Metres.
  /// Standard deviation per axis of pixel - projection; 0 if unknown. Either all pairs state it or
  /// none does.
  double sigma_px = 0.0;
  PairId id;
};

/// Whether the pair states its noise.
inline bool HasKnownNoise(const Pair3d3d& pair) {
  return pair.covariance_in_cam.has_value() || pair.sigma_m > 0.0;
}
inline bool HasKnownNoise(const Pair2d3d& pair) { return pair.sigma_px > 0.0; }

/// Points of the same objects in both frames. Metres.
struct PointSets {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
};

/// The data of one LiDAR and one camera. Solvers state which parts they need.
struct CalibrationProblem {
  std::optional<Camera> camera;
  std::vector<Pair3d3d> pairs_3d3d;
  std::vector<Pair2d3d> pairs_2d3d;
  PointSets point_sets;  ///< With unknown pairing.
  /// Raw observations; their boards are among `boards`, and they need the camera.
  std::vector<BoardView> board_views;
  LidarErrorModel lidar_errors;  ///< For the returns in board_views.
  std::vector<Board> boards;  ///< Known boards, with the ids used in pairs and views; may be empty.
  std::optional<Rigid3d> initial_cam_from_lidar;
};

/// The points of the pairs, still paired by index.
PointSets PointsOf(std::span<const Pair3d3d> pairs);

/// The points of the pairs as unpaired sets, each sorted by coordinates so that the order contains
/// no information on the pairing.
PointSets WithholdPairing(std::span<const Pair3d3d> pairs);

}  // namespace sextant
