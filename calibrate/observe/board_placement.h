// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/board.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// One way in which a board may lie on a patch of a scan. Scans do not show prints, so a square
/// board may be there in four ways and a rectangular one in two.
struct BoardPlacement {
  int board = 0;  ///< Place within the boards.
  int turn = 0;   ///< Quarter turns, clockwise as seen, from corner 0 at the top.
  Rigid3d lidar_from_board{};
  RectangleFit fit{};      ///< Sides numbered as the board's own.
  LidarCorners corners{};  ///< Numbered as the board's own.
  /// What the outline itself says against this way: chi-square of its edge points above that of
  /// the patch's best placement, in units in which that one has one a point; 25 at most, for what
  /// a sensor does to an outline is not all in the points' sigmas.
  double misfit = 0.0;
};

/// Every way in which the patch may be one of the boards, by ascending misfit, without those of a
/// clearly other size than the best (by an eighth) that the outline refuses. Empty where no corners
/// can be extracted from it; `why` then says the reason. Errors: kUnknownName for an extractor that
/// does not exist.
Expected<std::vector<BoardPlacement>> PlaceBoards(const BoardPatch& patch,
                                                  std::span<const Board> boards,
                                                  const std::string& extractor, std::string& why);

/// The board as it looks after quarter turns clockwise about its centre, for what only its outline
/// and opening matter: prints are left out.
Board Turned(const Board& board, int quarter_turns);

}  // namespace sextant
