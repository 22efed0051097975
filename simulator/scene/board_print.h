// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/error.h"
#include "features/camera/tag_pattern.h"
#include "geometry/board.h"

namespace sextant {

/// A patch of one colour of a board's front. Two points of the same layer and cell have all points
/// between them in that cell too, except in layer 0, which tags and checkers interrupt.
struct PrintCell {
  int layer = 0;  ///< 0 the bare board, 1 and on its tags in their order, then the checkerboard.
  int cell = 0;
  bool is_white = true;
};

/// What is printed on a board's front: white, with black cells of tags and of a checkerboard.
///
/// A tag's cells are its detector library's, scaled so that the square whose corners the detector
/// reports has sides of `edge_m`; some families print beyond it. The checkerboard has
/// (inner_columns + 1) x (inner_rows + 1) squares, black at the top-left.
class BoardPrint {
 public:
  /// Errors: kUnknownName for a tag family; kInvalidInput for an id that the family does not have
  /// and for what FindBoardFault() finds. Messages name the board.
  static Expected<BoardPrint> Make(const Board& board);

  /// The outline and the hole are not looked at. Point: board frame, m.
  PrintCell At(const Eigen::Vector2d& point_in_board_m) const;

 private:
  struct Tag {
    TagPattern pattern;
    Eigen::Vector2d center_m;
    Eigen::Vector2d tag_x_in_board;  ///< Unit; the tag's y is it turned clockwise as seen.
    double cell_m = 0.0;
  };
  BoardPrint() = default;

  std::vector<Tag> tags_;
  BoardChecker checker_;  ///< square_m 0: none.
};

}  // namespace sextant
