// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/calibration_problem.h"

namespace sextant {

struct DataNeeds;

/// The problem with only the pairs at `indices` of the kind in `needs` (3D-3D where it has both);
/// camera, boards and initial pose are kept, everything else is left out.
CalibrationProblem SubsetOf(const CalibrationProblem& problem, const DataNeeds& needs,
                            std::span<const int> indices);

}  // namespace sextant
