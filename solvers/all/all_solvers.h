// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/registry.h"

namespace sextant {

/// Every solver that this build has: BuiltinSolvers(), and those of AddOpenCvSolvers where OpenCV
/// was found.
SolverRegistry AllSolvers();

}  // namespace sextant
