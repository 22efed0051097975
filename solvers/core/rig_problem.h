// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/lidar_errors.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A camera or a LiDAR of a rig. Its frame is named by it.
struct RigSensor {
  std::string name{};
  std::optional<Camera> camera{};  ///< None: a LiDAR, or another sensor that measures in 3D.
  LidarErrorModel lidar_errors{};  ///< For returns; see RigObservation::raw.
};

/// A point of a board, such as a corner or the centre of a hole, measured in 3D.
struct MeasuredPoint {
  Eigen::Vector3d in_board_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d in_sensor_m = Eigen::Vector3d::Zero();
  double sigma_m = 0.01;  ///< Per axis.
};

/// The plane of a board's front, normal . point = distance_m; either direction of the normal.
struct MeasuredPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();  ///< Unit, in the sensor frame.
  double distance_m = 0.0;
  double sigma_rad = 0.005;  ///< The normal's, about each axis in the plane.
  double sigma_m = 0.005;    ///< The distance's, at the board's centre.
};

/// The line along one of a board's sides; either direction.
struct MeasuredLine {
  int side = 0;                                          ///< As in EdgeRay.
  Eigen::Vector3d point = Eigen::Vector3d::Zero();       ///< On it, in the sensor frame [m].
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< Unit.
  double sigma_m = 0.01;  ///< Each end of the side, along both axes across.
};

/// What one sensor measured of one board at one moment.
struct RigObservation {
  std::size_t sensor = 0;  ///< Index into RigProblem::sensors.
  /// A camera's printed points, or a LiDAR's face returns and edge rays, in the frame of that
  /// sensor. The poses in it are not used.
  BoardView raw{};
  std::vector<MeasuredPoint> points{};
  std::optional<MeasuredPlane> plane{};
  std::vector<MeasuredLine> lines{};
  /// When it was measured, by the sensor's own clock; none: while the board stood still.
  std::optional<double> time_s{};
  /// A rough pose from this observation alone; needed for face returns and edge rays, which do not
  /// give one in closed form.
  std::optional<Rigid3d> sensor_from_board{};
};

/// One board at one place: all that sensors measured of it while it stood still, or, where the
/// observations have times, while it moved with constant velocity; a sensor may then see it
/// several times.
struct RigPlacement {
  int moment = 0;
  int board = 0;       ///< Board::id.
  std::string name{};  ///< The moment's name, for people; empty: its number is shown.
  std::vector<RigObservation> seen{};
};

/// The data of any number of cameras and LiDARs that see boards.
struct RigProblem {
  std::vector<RigSensor> sensors{};
  std::vector<Board> boards{};
  std::vector<RigPlacement> placements{};
};

}  // namespace sextant
