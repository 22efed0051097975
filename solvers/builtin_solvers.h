// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/core/registry.h"

namespace sextant {

/// Every solver of this library; the table is in builtin_solvers.cc.
SolverRegistry BuiltinSolvers();

}  // namespace sextant
