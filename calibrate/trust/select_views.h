// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// The numbers of all views in pairs and board views, ascending.
std::vector<int> ViewsOf(const CalibrationProblem& problem);

/// The problem with the data of these views only.
CalibrationProblem SelectViews(const CalibrationProblem& problem, std::span<const int> views);

/// A bootstrap sample: the problem with views drawn with replacement. The i-th of `drawn` becomes
/// view i, so that a view that was drawn twice counts as two.
CalibrationProblem ResampleViews(const CalibrationProblem& problem, std::span<const int> drawn);

}  // namespace sextant
