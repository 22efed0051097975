// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// The views that pairs and board views name, ascending.
std::vector<int> ViewsOf(const CalibrationProblem& problem);

/// The problem with the data of these views alone.
CalibrationProblem SelectViews(const CalibrationProblem& problem, std::span<const int> views);

/// The problem with the data of views drawn with replacement: the i-th of `drawn` becomes view i,
/// so that a view that was drawn twice counts as two.
CalibrationProblem DrawViews(const CalibrationProblem& problem, std::span<const int> drawn);

}  // namespace sextant
