// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/solver.h"

namespace sextant {

/// Whether kernels that solve triples of pixels side by side (FindP3pConsensus, StartFromTriples)
/// may stand for `solver`: it is p3p, and the camera has no distortion.
bool IsP3pOfPinhole(const Solver& solver, const CalibrationProblem& problem);

}  // namespace sextant
