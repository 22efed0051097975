// SPDX-License-Identifier: Apache-2.0
#include "solvers/all/all_solvers.h"

#include "solvers/builtin_solvers.h"
#ifdef SEXTANT_WITH_OPENCV_SOLVERS
#include "solvers/opencv/opencv_solvers.h"
#endif

namespace sextant {

SolverRegistry AllSolvers() {
  SolverRegistry registry = BuiltinSolvers();
#ifdef SEXTANT_WITH_OPENCV_SOLVERS
  AddOpenCvSolvers(registry);
#endif
  return registry;
}

}  // namespace sextant
