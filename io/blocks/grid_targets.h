// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "geometry/board.h"

namespace sextant {

/// Kalibr's AprilGrid: tags of tag36h11 with a black border of two cells, upright, numbered along
/// the rows from the bottom left up.
struct AprilGrid {
  int columns = 0;
  int rows = 0;
  double tag_m = 0.0;    ///< Side of a tag, over its black border.
  double spacing = 0.0;  ///< Distance between two tags, relative to their side.
  int first_id = 0;
  Eigen::Vector2d center_in_board_m = Eigen::Vector2d::Zero();

  /// Size of the printed grid along x and y [m], with a distance between tags all around it.
  Eigen::Vector2d Size() const {
    const double pitch = tag_m * (1.0 + spacing);
    return {columns * pitch + tag_m * spacing, rows * pitch + tag_m * spacing};
  }
};

/// OpenCV's ChArUco board: a checkerboard with a tag in each white square, numbered along the rows
/// from the top left down.
struct CharucoGrid {
  int columns = 0;  ///< Squares.
  int rows = 0;
  double square_m = 0.0;
  double marker_m = 0.0;
  std::string family{};
  int first_id = 0;
  /// As made by OpenCV before 4.6: the top-left square is white if the number of rows is even.
  bool legacy = false;
  Eigen::Vector2d center_in_board_m = Eigen::Vector2d::Zero();
};

/// Appends the tags of a grid to the board.
void AddTo(const AprilGrid& grid, Board& board);

/// Appends the tags and sets the checkerboard.
void AddTo(const CharucoGrid& grid, Board& board);

}  // namespace sextant
