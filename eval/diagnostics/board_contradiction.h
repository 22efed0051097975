// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Boards that fit well one by one, but not together under one pose.
struct BoardContradiction {
  bool in_pixels = false;
  double rmse_together = 0.0;  ///< [m or px]
  double rmse_alone = 0.0;     ///< Every board under its own pose [m or px].
  /// Largest distance between the positions of a board by its own pose and by another board's; 0
  /// for pixels, where one board hardly determines it.
  double apart_m = 0.0;
  /// The boards that agree with each other do not clearly outnumber others that agree among
  /// themselves: the data does not determine which pose is right.
  bool is_undecided = false;
};

/// For 3D-3D pairs the complete boards, where there are two: the RMSE together is more than three
/// times that of poses of their own and more than a tenth of the mean edge, or six times and a
/// twentieth. It is undecided if it is at least six times that alone, and nearly as many boards
/// (kRivalShare) as agree in the largest group agree in another.
///
/// Where there are no 3D-3D pairs, boards of at least four 2D-3D pairs, only if undecided: the RMSE
/// together is at least three times that alone, more than 0.03 of the mean distance to a neighbour,
/// and larger by an F-test at 0.2 %, or at 4 % above 4 px; not because of a fifth of the pairs or
/// less, without which it would be that of noise; and the boards are two, or most of them are in
/// two groups of several.
///
/// At most 16 boards, evenly spread, are compared with each other, and 2D-3D pairs of others are
/// not examined.
std::optional<BoardContradiction> FindContradiction(const CalibrationProblem& problem);

}  // namespace sextant
