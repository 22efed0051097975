// SPDX-License-Identifier: Apache-2.0
#include <cstdio>

#include "solvers/all/all_solvers.h"

// Makes every solver by its example, and prints their names; 0 where all can be made.
int main() {
  const sextant::SolverRegistry registry = sextant::AllSolvers();
  for (const sextant::SolverEntry& entry : registry.entries()) {
    const sextant::Expected<sextant::SolverPtr> solver = registry.Make(entry.example);
    if (!solver) {
      std::puts(solver.error().message.c_str());
      return 1;
    }
    std::puts(entry.name.c_str());
  }
  return registry.entries().empty() ? 1 : 0;
}
