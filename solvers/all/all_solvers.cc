// SPDX-License-Identifier: Apache-2.0
#include "solvers/all/all_solvers.h"

#include "solvers/builtin_solvers.h"
#include "solvers/external/imported_solver.h"
#ifdef SEXTANT_WITH_OPENCV_SOLVERS
#include "solvers/opencv/opencv_solvers.h"
#endif

namespace sextant {

SolverRegistry AllSolvers(Commands commands) {
  SolverRegistry registry = BuiltinSolvers();
#ifdef SEXTANT_WITH_OPENCV_SOLVERS
  AddOpenCvSolvers(registry);
#endif
  registry.Add(CommandEntry(commands));
  registry.Add(ImportedEntry());
  return registry;
}

}  // namespace sextant
