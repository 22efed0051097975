// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Indices of the four pairs of one board in one view, by corner number.
struct BoardPairs {
  int view = 0;
  std::array<int, kCornersPerBoard> pairs{};

  std::size_t pair(int corner) const {
    return static_cast<std::size_t>(pairs[static_cast<std::size_t>(corner)]);
  }
};

/// All boards with each of their four corners exactly once, ordered by view and board.
std::vector<BoardPairs> CompleteBoards(std::span<const Pair3d3d> pairs);

}  // namespace sextant
