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

/// One board of `marker_coordinates.txt`: its sides and the position of its marker.
struct MarkerBoard {
  double side1_m = 0.0;    ///< Length of the edge from corner 1 (right) to corner 2 (bottom).
  double side2_m = 0.0;    ///< Length of the edge from corner 0 (top) to corner 1 (right).
  double border1_m = 0.0;  ///< Between the board's and the marker's edge, along side 1.
  double border2_m = 0.0;  ///< The same along side 2.
  double marker_m = 0.0;   ///< Side of the marker.
};

/// Reads the number of boards, then s1, s2, b1, b2 and e for each, all in cm.
/// Which side is s1 and which s2 was determined from the package's own recorded session.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
/// Time and memory are linear in the file's size; at most kMaxBoards boards.
Expected<std::vector<MarkerBoard>> ReadMarkerCoordinates(const std::filesystem::path& path);
Expected<std::vector<MarkerBoard>> ParseMarkerCoordinates(std::string_view text,
                                                          const std::string& file);

/// The boards with the ids 0, 1, ..., as in the pairs of points.txt.
std::vector<Board> BoardsOf(const std::vector<MarkerBoard>& markers);

/// One line of `transform.txt`: a marker detected in the image.
struct DetectedMarker {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px{};
  Eigen::Vector3d translation_m = Eigen::Vector3d::Zero();  ///< Translation of cam_from_marker.
  Eigen::Vector3d rotation_rad = Eigen::Vector3d::Zero();   ///< Rotation vector of cam_from_marker.
};

/// Reads lines `id=(u,v) (u,v) (u,v) (u,v) Txyz=x y z Rxyz=x y z`.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
/// Time is linear in the file's size, memory at most 20 times it.
Expected<std::vector<DetectedMarker>> ReadDetectedMarkers(const std::filesystem::path& path);
Expected<std::vector<DetectedMarker>> ParseDetectedMarkers(std::string_view text,
                                                           const std::string& file);

}  // namespace sextant
