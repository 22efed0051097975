// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "base/error.h"
#include "features/lidar/board_finder.h"
#include "geometry/scan_marks.h"

namespace sextant {

/// The boards that a person marked (Dhall et al. 2017, who draw the polygons by hand), ready for
/// every corner extractor, in the order of `marks`.
///
/// Of a board: the nearest plane within the convex hull of its four areas that returns of each area
/// lie on; of these, per area and ring, the last one outwards, which is an EdgePoint of the area's
/// edge whatever its outline says. Returns whose ring goes on beyond the area on the plane are no
/// ends and left out. Ends between rings and a hollow board's opening are found as FindBoards does.
/// The rectangle is fitted to all. Nothing else of FindBoards is asked: what was marked is a board.
///
/// `boards`: found by the ids of the marks. `options`: region is not looked at.
/// Errors: kMissingData for nothing marked and for a board without all four areas; kInvalidInput
/// for a board of unknown id or without a size, and for sides that cannot be those that were
/// marked; kTooFewPairs for an area without an end of a ring, and kDegenerate where there is no
/// plane or the ends leave the rectangle open. Messages name the board and the edge.
Expected<std::vector<BoardPatch>> PatchesFromPolygons(const ScanRings& scan, const ScanMarks& marks,
                                                      std::span<const Board> boards,
                                                      const BoardSearchOptions& options = {});

}  // namespace sextant
