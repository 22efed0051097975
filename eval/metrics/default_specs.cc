// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/default_specs.h"

#include "eval/diagnostics/outlying_pairs.h"

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

std::string DefaultSpec(const SolverRegistry& registry, const CalibrationProblem& problem) {
  const std::size_t pixels = problem.pairs_2d3d.size();
  if (!problem.pairs_3d3d.empty() || pixels == 0) return "kabsch";
  if (pixels == 3) return "p3p";
  const std::string least_squares = "refine(sqpnp)";
  const std::string robust = "refine(ransac(p3p))";
  const auto answer_of = [&](const std::string& spec) {
    return registry.Make(spec).and_then([&](const SolverPtr& s) { return s->Solve(problem); });
  };
  const Expected<SolveReport> report = answer_of(least_squares);
  if (report && OutlyingResiduals(report->evaluation.per_pair_px, 2).empty()) return least_squares;
  return answer_of(robust) ? robust : least_squares;
}

}  // namespace sextant
