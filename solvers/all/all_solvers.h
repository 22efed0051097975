// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/registry.h"
#include "solvers/external/command_solver.h"

namespace sextant {

/// Every solver that this build has: BuiltinSolvers(), those of AddOpenCvSolvers where OpenCV was
/// found, and `command`, which by default refuses to run anything.
SolverRegistry AllSolvers(Commands commands = Commands::kRefused);

}  // namespace sextant
