// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "features/lidar/board_finder.h"

namespace sextant {

/// The boards that one patch of a scan may be, placed on it; at least one.
using PatchProposal = std::vector<BoardPatch>;

/// Small if the outline agrees on all sides and is supported by many edge points and returns.
/// Compares boards on one patch and patches for one board.
double Disagreement(const BoardPatch& patch);

/// Assigns a different board to as many patches as possible (augmenting paths), the best-fitting
/// first; orders boards of nearly the same size from left to right. Of patches of one place, as
/// where the clustering split a board, only the best is used. Appends to `search.found` and, for
/// patches without a board, to `search.others`.
void AssignBoards(const ScanRings& scan, std::span<const Board> boards,
                  std::vector<PatchProposal> proposals, BoardSearch& search);

}  // namespace sextant
