// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/error.h"
#include "features/camera/tags/tag_pattern.h"
#include "geometry/board.h"

namespace sextant {

/// A patch of one colour on a board's front. If two points have the same layer and cell, so have
/// all points between them, except in layer 0, which is interrupted by tags and checkerboards.
struct PrintCell {
  int layer = 0;  ///< 0: bare board; 1, 2, ...: tags in their order, then the checkerboard.
  int cell = 0;
  bool is_white = true;
};

/// The print on a board's front: white, with the black cells of tags and of a checkerboard.
///
/// A tag's cells are those of its detector library, scaled so that the square whose corners the
/// detector reports has sides of `edge_m`; some families extend beyond it. The checkerboard has
/// (inner_columns + 1) x (inner_rows + 1) squares.
class BoardPrint {
 public:
  /// Errors: kUnknownName for an unknown tag family; kInvalidInput for an id that the family does
  /// not have and for faults that FindBoardFault() reports. Messages name the board.
  static Expected<BoardPrint> Make(const Board& board);

  /// The cell at a point in the board frame [m]. The outline and the hole are ignored.
  PrintCell At(const Eigen::Vector2d& point_in_board_m) const;

 private:
  struct Tag {
    TagPattern pattern;
    Eigen::Vector2d center_m;
    /// Unit vector; the tag's y axis is this rotated clockwise as seen.
    Eigen::Vector2d tag_x_in_board;
    double cell_m = 0.0;
  };
  BoardPrint() = default;

  std::vector<Tag> tags_;
  BoardChecker checker_;  ///< square_m is 0 if there is none.
};

}  // namespace sextant
