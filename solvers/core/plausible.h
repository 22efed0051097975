// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Whether the answer explains the pixels that it is based on at all: at least half of their points
/// project, and to within the spread of the pixels, which a pose that projects all points onto one
/// pixel leaves. Half of them, as outliers, and few points near the plane of the camera, project
/// anywhere. An answer that fails this is none, whoever computed it. Three pairs, which every pose
/// of p3p fits, and solvers of other data always pass.
/// Error: kNoConsensus.
Expected<void> CheckPlausible(const CalibrationProblem& problem, const SolverSpec& spec,
                              const SolveReport& report);

}  // namespace sextant
