// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/calibration_problem.h"

namespace sextant {

struct DataNeeds;

/// The problem with only the pairs at `indices` of the kind that `needs` asks for (3D-3D where it
/// asks for both); the rest unchanged, point sets left out.
CalibrationProblem SubsetOf(const CalibrationProblem& problem, const DataNeeds& needs,
                            std::span<const int> indices);

}  // namespace sextant
