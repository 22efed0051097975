// SPDX-License-Identifier: Apache-2.0
#include "eval/default_specs.h"

namespace sextant {

std::vector<std::string> DefaultSpecs(const SolverRegistry& registry,
                                      const CalibrationProblem& problem) {
  std::vector<std::string> specs;
  const auto add_if_met = [&](const std::string& spec) {
    const Expected<SolverPtr> solver = registry.Make(spec);
    if (solver && CheckProblem(problem, (*solver)->spec())) specs.push_back((*solver)->spec().name);
  };
  for (const SolverEntry& entry : registry.entries()) {
    if (!entry.wraps_solver) {
      add_if_met(entry.name);
      continue;
    }
    for (const char* inner : {"kabsch", "epnp"}) add_if_met(entry.name + "(" + inner + ")");
  }
  return specs;
}

}  // namespace sextant
