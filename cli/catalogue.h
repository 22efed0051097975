// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/registry.h"

namespace sextant::cli {

/// Every solver that this build has.
SolverRegistry AllSolvers();

}  // namespace sextant::cli
