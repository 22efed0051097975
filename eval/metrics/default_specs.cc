// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/default_specs.h"

namespace sextant {

std::vector<std::string> DefaultSpecs(const SolverRegistry& registry,
                                      const CalibrationProblem& problem) {
  std::vector<std::string> specs;
  bool any_whole_pose = false;
  const auto add_if_met = [&](const std::string& spec) {
    const Expected<SolverPtr> solver = registry.Make(spec);
    if (!solver || !CheckProblem(problem, (*solver)->spec())) return;
    // Whether the points lie on a plane is only known after a fit.
    if ((*solver)->spec().needs.points_on_plane && !(*solver)->Solve(problem)) return;
    specs.push_back((*solver)->spec().name);
    any_whole_pose = any_whole_pose || FindsWholePose((*solver)->spec());
  };
  for (const SolverEntry& entry : registry.entries()) {
    if (!entry.wraps_solver) {
      add_if_met(entry.name);
      continue;
    }
    for (const char* inner : {"kabsch", "epnp"}) add_if_met(entry.name + "(" + inner + ")");
  }
  const bool sets_given = problem.point_sets.in_cam.size() >= 3;
  if (!any_whole_pose && !sets_given) specs.clear();
  return specs;
}

}  // namespace sextant
