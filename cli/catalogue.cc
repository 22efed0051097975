// SPDX-License-Identifier: Apache-2.0
#include "cli/catalogue.h"

namespace sextant::cli {

SolverRegistry AllSolvers() { return BuiltinSolvers(); }

}  // namespace sextant::cli
