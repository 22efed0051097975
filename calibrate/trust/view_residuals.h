// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <utility>

#include "geometry/calibration_problem.h"
#include "solvers/core/evaluation.h"

namespace sextant {

/// How a board's corners fit an answer, in root mean square.
struct BoardResidual {
  double rmse_m = 0.0;
  std::optional<double> rmse_px{};  ///< None where a corner does not project.
  double range_m = 0.0;             ///< Of its middle from the camera.
};

/// Of every board of every view, by (view, Board::id).
std::map<std::pair<int, int>, BoardResidual> ResidualsByBoard(const CalibrationProblem& problem,
                                                              const Evaluation& evaluation);

}  // namespace sextant
