// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "geometry/calibration_problem.h"
#include "solvers/core/evaluation.h"

namespace sextant {

/// RMS residuals of a board's corners.
struct BoardResidual {
  double rmse_m = 0.0;
  std::optional<double> rmse_px{};  ///< None where a corner does not project.
  double range_m = 0.0;             ///< From the camera to its centre.
};

/// The residuals of every board in every view, by (view, Board::id).
std::map<std::pair<int, int>, BoardResidual> ResidualsByBoard(const CalibrationProblem& problem,
                                                              const Evaluation& evaluation);

}  // namespace sextant
