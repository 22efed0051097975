// SPDX-License-Identifier: Apache-2.0
#include "cli/catalogue.h"

#ifdef SEXTANT_WITH_OPENCV_SOLVERS
#include "solvers/builtin_solvers.h"
#include "solvers/opencv/opencv_solvers.h"
#endif

namespace sextant::cli {

SolverRegistry AllSolvers() {
  SolverRegistry registry = BuiltinSolvers();
#ifdef SEXTANT_WITH_OPENCV_SOLVERS
  AddOpenCvSolvers(registry);
#endif
  return registry;
}

}  // namespace sextant::cli
