// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/rigid3d.h"

namespace sextant {

/// Points printed on a board and where a camera saw them, with errors that may go together: the
/// four corners of a tag, or the inner corners of a checkerboard.
struct BoardPoints {
  std::vector<Eigen::Vector2d> in_board_m{};
  std::vector<Eigen::Vector2d> pixels{};
  Eigen::MatrixXd covariance_px2{};  ///< 2n x 2n, of (x0, y0, x1, y1, ...).
};

/// A ray of the LiDAR that meets the board's plane where one of its sides is.
struct EdgeRay {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< Unit, in the LiDAR frame.
  int side = 0;  ///< 0 from corner 0 to 1, clockwise; 4 to 7 of the opening.
  /// Standard deviation of where it meets the plane, across the side, in the plane: half a step
  /// between samples (uniform) and the beam's spot.
  double sigma_m = 0.0;
};

/// What both sensors saw of one board at one moment, before anything is fitted to it: the data of
/// the joint solver. Which board and which corner is which has been settled: both poses place the
/// same corner 0.
struct BoardView {
  int view = 0;   ///< The moment: an image and a scan.
  int board = 0;  ///< Board::id.
  std::vector<BoardPoints> printed{};
  std::vector<Eigen::Vector3d> face_in_lidar{};  ///< Returns from the face, as measured [m].
  double range_sigma_m = 0.0;                    ///< Of each of them, along its ray.
  std::vector<EdgeRay> edges{};
  Rigid3d cam_from_board{};    ///< By the image alone.
  Rigid3d lidar_from_board{};  ///< By the scan alone.
};

}  // namespace sextant
