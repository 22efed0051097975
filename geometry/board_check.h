// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>

#include "geometry/board.h"

namespace sextant {

/// A contradiction in a board's description: its part and field, and the reason.
struct BoardFault {
  enum class Part { kBoard, kHole, kRoundHole, kTag, kChecker };

  Part part = Part::kBoard;
  int index = 0;        ///< Index into Board::round_holes or Board::tags, for these parts.
  std::string field{};  ///< "edge_m", as the board file names it; empty: the part as a whole.
  std::string message{};
};

/// Why a size is probably not in metres: "600 m? sizes are in metres"; none up to 10 m.
std::optional<std::string> DoubtfulSize(double size_m);

/// The first fault of a board: sizes that are not positive and finite or over 10 m, a hole or print
/// that is not entirely on the board, prints and holes that overlap each other, an id of one family
/// twice. Tags of a checkerboard that holds tags must lie within its white squares. Touching is not
/// an overlap. Whether a family has an id is checked in features/camera.
std::optional<BoardFault> FindBoardFault(const Board& board);

/// Corners of a tag in the board frame [m], clockwise as seen from the tag's own top-left.
std::array<Eigen::Vector2d, 4> TagCorners(const BoardTag& tag);

/// Corners of a board in its own frame [m]: the 4 outer ones, then the 4 of its hole, if any.
std::vector<Eigen::Vector2d> CornersInBoard(const Board& board);

/// The number that a side or rim gets when the board's frame is turned by quarter turns clockwise,
/// as seen, on the same board; -1 for a rim where the turned board has no hole.
int SideAfterTurn(const Board& board, int side, int quarter_turns);

/// Whether all openings are at the same places after 1 to 3 quarter turns; true without any.
bool HolesAllowTurns(const Board& board, int quarter_turns);

}  // namespace sextant
