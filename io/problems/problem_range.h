// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// Whether the problem's coordinates and noise are within the ranges of
/// geometry/coordinate_range.h. Points that are all the same pass: solvers name that case. Error:
/// kInvalidInput, with the kind and number of the datum, without the file. Time is linear in the
/// points.
Expected<void> CheckRange(const CalibrationProblem& problem);

}  // namespace sextant
