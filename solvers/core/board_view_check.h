// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// The board of that id; null where there is none.
const Board* FindBoard(std::span<const Board> boards, int id);

/// Whether the view can be worked with: its board known and with a size, finite numbers, as many
/// pixels as printed points, covariances of their size that are symmetric positive definite, rays
/// of unit length to sides that the board has, positive sigmas.
/// Errors: kNonFinite, kInvalidInput.
Expected<void> CheckBoardView(const BoardView& view, std::span<const Board> boards);

/// All views, and that no board is in one moment twice.
Expected<void> CheckBoardViews(std::span<const BoardView> views, std::span<const Board> boards);

}  // namespace sextant
