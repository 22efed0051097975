// SPDX-License-Identifier: Apache-2.0
#include "solvers/all/all_solvers.h"
#include "tests/fuzz/entry_point.h"
#include "tests/fuzz/outcome.h"

namespace sextant::test {

SEXTANT_FUZZ_TARGET(solver_spec, bytes) {
  static const SolverRegistry registry = AllSolvers();
  const Expected<SolverPtr> solver = registry.Make(bytes);
  CheckOutcome(solver);
  if (!solver) return;
  const std::string& name = (*solver)->spec().name;
  const Expected<SolverPtr> again = registry.Make(name);
  if (!again || (*again)->spec().name != name)
    Fault("a solver whose name is no spec of it: " + name);
}

}  // namespace sextant::test
