// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"

namespace sextant {

/// Points printed on a board and their pixels in an image, with correlated errors: the four corners
/// of a tag, or the inner corners of a checkerboard.
struct BoardPoints {
  std::vector<Eigen::Vector2d> in_board_m{};
  std::vector<Eigen::Vector2d> pixels{};
  Eigen::MatrixXd covariance_px2{};  ///< 2n x 2n, in the order (x0, y0, x1, y1, ...).
};

/// A ray of the LiDAR that intersects the board's plane on one of its sides.
struct EdgeRay {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< Unit, in the LiDAR frame.
  /// 0 from corner 0 to 1, clockwise; 4 to 7 for the opening; from kFirstRim on the rims of the
  /// round holes.
  int side = 0;
  /// Standard deviation of the intersection, across the side, in the plane: from half a step
  /// between samples (uniform) and the beam's spot.
  double sigma_m = 0.0;
};

/// Raw observations of one board by both sensors at one time: the data of the joint solver. Boards
/// and corners are already associated: both poses have the same corner 0.
struct BoardView {
  int view = 0;        ///< Number of the image and scan.
  int board = 0;       ///< Board::id.
  std::string name{};  ///< The view's name, for people; empty: its number is shown.
  std::vector<BoardPoints> printed{};
  std::vector<Eigen::Vector3d> face_in_lidar{};  ///< Returns from the face, as measured [m].
  /// The ring of each face return, the same number in all views; empty where there are no rings.
  std::vector<int> face_rings{};
  double range_sigma_m = 0.0;  ///< Each return, along its ray.
  std::vector<EdgeRay> edges{};
  Rigid3d cam_from_board{};    ///< From the image alone.
  Rigid3d lidar_from_board{};  ///< From the scan alone.
};

}  // namespace sextant
