// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "calibrate/match/match.h"
#include "calibrate/observe/observe.h"
#include "geometry/board.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// For each view the first one that has the same boards in its image and in its scan, to the last
/// digit: a copy of that view, with nothing new. None for others, and for views without boards.
/// O(n log n) in the number of views.
std::vector<std::optional<std::size_t>> FindCopies(std::span<const Observation> views);

/// A board that several views show in one place.
struct RepeatedPlacement {
  int board = 0;             ///< Index into the boards.
  std::vector<int> views{};  ///< Ascending; at least two.
};

/// Finds the kept boards whose corners are, in both sensors, within three sigmas or `floor_m` (root
/// mean square) of where an earlier view has them. What is wrong there, such as the lens or the
/// board's outline in the scan, is wrong in all of these views alike. O(n^2) in the number of kept
/// boards, with a nanosecond for most of the pairs.
std::vector<RepeatedPlacement> FindRepeatedPlacements(std::span<const Observation> views,
                                                      std::span<const MatchedBoard> kept,
                                                      double floor_m);

/// Multiplies the variances of a placement's data by the number of its views, so that these weigh
/// as much as one view. The answer then rests on their mean.
void CountPlacementsOnce(std::span<const RepeatedPlacement> placements,
                         std::span<const Board> boards, CalibrationProblem& problem);

/// Views that share a placement, directly or by way of others; without views that share none.
std::vector<std::vector<int>> ViewsThatShare(std::span<const RepeatedPlacement> placements);

}  // namespace sextant
