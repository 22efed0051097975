// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// The board with that id; null where there is none.
const Board* FindBoard(std::span<const Board> boards, int id);

/// Whether the view is usable: its board is known and has a size; numbers are finite; there are as
/// many pixels as printed points; covariances have their size and are symmetric positive definite;
/// rays have unit length and name sides that the board has; sigmas are positive.
/// Errors: kNonFinite, kInvalidInput.
Expected<void> CheckBoardView(const BoardView& view, std::span<const Board> boards);

/// Checks all views, and that no board is in one view twice.
Expected<void> CheckBoardViews(std::span<const BoardView> views, std::span<const Board> boards);

}  // namespace sextant
