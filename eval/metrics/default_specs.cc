// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/default_specs.h"

#include "eval/diagnostics/outlying_pairs.h"
#include "eval/diagnostics/without_noise.h"

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
  const std::size_t points = problem.pairs_3d3d.size();
  const bool in_pixels = points == 0 && pixels > 0;
  if (in_pixels && pixels == 3) return "p3p";
  std::string least_squares = in_pixels ? "refine(sqpnp)" : "kabsch";
  std::string robust = in_pixels ? "refine(ransac(p3p))" : "robust(kabsch)";
  if (points + pixels == 0) return least_squares;
  const auto answer_of = [&](const std::string& spec, const CalibrationProblem& pairs) {
    return registry.Make(spec).and_then([&](const SolverPtr& s) { return s->Solve(pairs); });
  };
  // Judged by the robust answer: outliers, if they are many, spoil the other one so that none of
  // them stands out.
  const Expected<SolveReport> answer = answer_of(robust, WithoutNoise(problem));
  if (!answer) return least_squares;
  if (!OutlyingPairs(*answer, in_pixels).empty()) return robust;
  return in_pixels && !answer_of(least_squares, problem) ? robust : least_squares;
}

}  // namespace sextant
