// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "base/error.h"
#include "features/lidar/board_finder.h"
#include "geometry/scan_marks.h"

namespace sextant {

/// Makes patches for every corner extractor from boards that a person marked (Dhall et al. 2017
/// draw such polygons by hand), in the order of `marks`.
///
/// The plane of a board is the nearest one, among the returns within the convex hull of its four
/// areas, that has returns in each area. Per area and ring, the outermost return on it becomes an
/// EdgePoint of the area's edge, wherever the fitted outline is. Returns whose ring continues on
/// the plane beyond the area are not ends and are omitted. Ends between rings and the opening of a
/// hollow board are found as in FindBoards. The rectangle is fitted to all edge points. The other
/// checks of FindBoards do not apply, since a person has confirmed the board.
///
/// `boards`: looked up by the ids of the marks. `options`: the region is ignored.
/// Errors: kMissingData if nothing is marked or a board lacks one of its four areas; kInvalidInput
/// for a board of unknown id or without a size, and for sides that do not match the marked edges;
/// kTooFewPairs for an area without an end of a ring; kDegenerate if there is no plane or the ends
/// do not determine the rectangle. Messages name the board and the edge.
Expected<std::vector<BoardPatch>> PatchesFromPolygons(const ScanRings& scan, const ScanMarks& marks,
                                                      std::span<const Board> boards,
                                                      const BoardSearchOptions& options = {});

}  // namespace sextant
