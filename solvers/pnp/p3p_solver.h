// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/solver.h"

namespace sextant {

/// Whether the vectorised kernels for triples of pixels (FindP3pConsensus, StartFromTriples) may
/// replace `solver`: it is p3p, and the camera has no distortion.
bool IsP3pOfPinhole(const Solver& solver, const CalibrationProblem& problem);

/// The solver `p3p`.
SolverPtr MakeP3p();

}  // namespace sextant
