// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"

namespace sextant {

/// One board of `marker_coordinates.txt`: its sides, and where its marker sits.
struct MarkerBoard {
  double side1_m = 0.0;    ///< From the right to the bottom corner.
  double side2_m = 0.0;    ///< From the top to the right corner.
  double border1_m = 0.0;  ///< Between the board's and the marker's edge, along side 1.
  double border2_m = 0.0;  ///< The same along side 2.
  double marker_m = 0.0;   ///< Side of the marker.
};

/// The number of boards, then for each s1, s2, b1, b2 and e, all in cm.
/// Which side is which was measured on the package's own session.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
Expected<std::vector<MarkerBoard>> ReadMarkerCoordinates(const std::filesystem::path& path);
Expected<std::vector<MarkerBoard>> ParseMarkerCoordinates(std::string_view text,
                                                          const std::string& file);

/// The boards with the ids 0, 1, ... that the reader of points.txt gives them.
std::vector<Board> BoardsOf(const std::vector<MarkerBoard>& markers);

/// One line of `transform.txt`: a marker as the camera found it.
struct DetectedMarker {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px{};
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();  ///< cam_from_marker.
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();   ///< Rotation vector of cam_from_marker.
};

/// Lines `id=(u,v) (u,v) (u,v) (u,v) Txyz=x y z Rxyz=x y z`.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
Expected<std::vector<DetectedMarker>> ReadDetectedMarkers(const std::filesystem::path& path);
Expected<std::vector<DetectedMarker>> ParseDetectedMarkers(std::string_view text,
                                                           const std::string& file);

}  // namespace sextant
