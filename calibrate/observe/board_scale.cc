// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/board_scale.h"

namespace sextant {

void ScaleOutline(double factor, Board& board) {
  board.top_right_m *= factor;
  board.right_bottom_m *= factor;
  if (board.hole) {
    board.hole->width_m *= factor;
    board.hole->height_m *= factor;
    board.hole->center_in_board_m *= factor;
  }
  for (RoundHole& hole : board.round_holes) {
    hole.radius_m *= factor;
    hole.center_in_board_m *= factor;
  }
}

void ScalePrint(double factor, Board& board) {
  for (BoardTag& tag : board.tags) {
    tag.edge_m *= factor;
    tag.center_in_board_m *= factor;
  }
  if (board.checker) {
    board.checker->square_m *= factor;
    board.checker->center_in_board_m *= factor;
  }
}

}  // namespace sextant
