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

/// One hypothesis of which board a patch of a scan is, and how it is turned. Scans do not show
/// prints, so a square board has four hypotheses and a rectangular one two.
struct BoardPlacement {
  int board = 0;  ///< Index into the boards.
  int turn = 0;   ///< Quarter turns clockwise, as seen by the sensor, from the outline of the fit.
  Rigid3d lidar_from_board{};
  RectangleFit fit{};      ///< Sides in the board's own numbering.
  LidarCorners corners{};  ///< In the board's own numbering.
  /// How much worse the outline fits than in the patch's best placement: difference in chi-square
  /// of the edge points, in units in which the best placement has 1 per point. At most 25, because
  /// the points' sigmas do not cover every distortion of an outline by the sensor.
  double misfit = 0.0;
};

/// Every placement of a board on the patch, by ascending misfit. Placements that differ from the
/// best in size by more than an eighth and whose chi-square is too large are omitted. Empty where
/// no corners can be extracted; `why` is then the reason. Errors: kUnknownName for an extractor
/// that does not exist.
Expected<std::vector<BoardPlacement>> PlaceBoards(const BoardPatch& patch,
                                                  std::span<const Board> boards,
                                                  const std::string& extractor, std::string& why);

/// The board after quarter turns clockwise about its centre: outline and opening only, without its
/// prints.
Board Turned(const Board& board, int quarter_turns);

}  // namespace sextant
