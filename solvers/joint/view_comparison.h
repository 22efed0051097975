// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// How one BoardView compares with the others.
struct ViewComparison {
  int view = 0;       ///< BoardView::view.
  bool used = false;  ///< False: one sensor only, or it contradicts the rest.
  /// How far both sensors' poses of the board are from the answer of the other views, as a quantile
  /// of the standard normal distribution. The noise of the view, that of the answer and the LiDAR's
  /// systematic errors are included, so that a far view may differ by more than a near one.
  double disagreement = 0.0;
};

/// One for each board view, by `joint` with its defaults from a start such as another solver's
/// answer. Requires board views that pass CheckBoardView, and the camera. Errors: those of `joint`.
/// Time: one solution.
Expected<std::vector<ViewComparison>> CompareViews(const CalibrationProblem& problem,
                                                   const Rigid3d& start);

}  // namespace sextant
