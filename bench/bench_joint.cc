// SPDX-License-Identifier: Apache-2.0
// Time of `joint` against the number of board views; the reported complexity is linear.
#include <benchmark/benchmark.h>

#include "bench/check.h"
#include "eval/synthetic/simulate_views.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant::bench {
namespace {

// A single view determines the pose only to some centimetres.
constexpr Tolerance kTolerance{.rotation_rad = 0.1, .translation_m = 0.2};

void SolveJoint(benchmark::State& state) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make("joint(kabsch)");
  const Expected<SimulatedViews> session =
      SimulateViews({.seed = 3, .views = static_cast<int>(state.range(0))});
  if (!solver || !session) {
    state.SkipWithError("no solver or no session");
    return;
  }
  const Expected<SolveReport> report = (*solver)->Solve(session->problem);
  if (!report) {
    state.SkipWithError(report.error().message.c_str());
    return;
  }
  if (!CheckPose(state, report->cam_from_lidar, session->true_cam_from_lidar, kTolerance)) return;
  for (auto _ : state) benchmark::DoNotOptimize((*solver)->Solve(session->problem));
  state.SetComplexityN(state.range(0));
  state.counters["iterations"] = report->iterations;
}
BENCHMARK(SolveJoint)
    ->Name("joint/sextant")
    ->RangeMultiplier(10)
    ->Range(1, 1000)
    ->Arg(4)
    ->Arg(40)
    ->Unit(benchmark::kMicrosecond)
    ->Complexity(benchmark::oN);

}  // namespace
}  // namespace sextant::bench

BENCHMARK_MAIN();
