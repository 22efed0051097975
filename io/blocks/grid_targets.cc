// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/grid_targets.h"

#include <numbers>

namespace sextant {
namespace {

// OpenCV numbers the corners of AprilTag's tags from another one than Kalibr does.
constexpr double kUpright_rad = std::numbers::pi;

// The centre of a cell of a centred grid.
Eigen::Vector2d CellCenter(int column, int row, int columns, int rows, double pitch_m) {
  return pitch_m * Eigen::Vector2d(column - 0.5 * (columns - 1), row - 0.5 * (rows - 1));
}

}  // namespace

void AddTo(const AprilGrid& grid, Board& board) {
  const double pitch_m = grid.tag_m * (1.0 + grid.spacing);
  for (int row = grid.rows - 1; row >= 0; --row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int number = (grid.rows - 1 - row) * grid.columns + column;
      board.tags.push_back(
          {.family = "aruco_tag36h11_border2",
           .id = grid.first_id + number,
           .edge_m = grid.tag_m,
           .center_in_board_m =
               grid.center_in_board_m + CellCenter(column, row, grid.columns, grid.rows, pitch_m),
           .rotation_rad = kUpright_rad});
    }
  }
}

void AddTo(const CharucoGrid& grid, Board& board) {
  const BoardChecker checker{.inner_columns = grid.columns - 1,
                             .inner_rows = grid.rows - 1,
                             .square_m = grid.square_m,
                             .center_in_board_m = grid.center_in_board_m,
                             .starts_white = grid.legacy && grid.rows % 2 == 0,
                             .holds_tags = true};
  int id = grid.first_id;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      if (((row + column) % 2 == 0) != checker.starts_white) continue;
      board.tags.push_back(
          {.family = grid.family,
           .id = id++,
           .edge_m = grid.marker_m,
           .center_in_board_m = grid.center_in_board_m +
                                CellCenter(column, row, grid.columns, grid.rows, grid.square_m)});
    }
  }
  board.checker = checker;
}

}  // namespace sextant
