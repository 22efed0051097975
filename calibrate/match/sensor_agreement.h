// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "calibrate/match/matched_board.h"
#include "calibrate/observe/observe.h"

namespace sextant {

/// Distance between the two sensors if a patch of the scan, so placed, is the board of the image
/// [m]: both sensors' positions in the board's frame. It depends on the ranges at which they see
/// the board and on the directions from which they see it, but not on the rotation between them.
double SensorsApart(const Observation& observation, const MatchedBoard& match);

/// Whether that distance is at most `max_apart_m`, or three sigma of the image's pose above it:
/// what both sensors see may then be the same board.
bool MayBeSameBoard(const Observation& observation, const MatchedBoard& match, double max_apart_m);

/// Why no patch of the scan may be that board of the image, for people: which distance, or which
/// direction, differs how much. None if one may, and where the scan has no patch.
std::optional<std::string> WhyNoneIsSameBoard(const Observation& observation, int sighting,
                                              double max_apart_m);

}  // namespace sextant
