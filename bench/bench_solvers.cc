// SPDX-License-Identifier: Apache-2.0
// Every solver of the catalogue through its interface, by the example that its entry gives. A new
// line in the table of solvers is timed here without a change.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <string>

#include "bench/check.h"
#include "solvers/registry.h"

namespace sextant::bench {
namespace {

// Ten sigmas of a single measurement: only a wrong answer is farther off.
constexpr Tolerance kTolerance = {.rotation_rad = 0.1, .translation_m = 0.1};

std::vector<RandomScene> ScenesFor(const SolverSpec& spec, int pairs) {
  RandomSceneOptions options{.pairs = pairs, .sigma_m = 0.01, .sigma_px = 1.0};
  if (!spec.is_global) options.max_rotation_rad = 0.1;
  if (!spec.estimates_rotation) options.max_rotation_rad = 0.0;
  options.planar = spec.needs.points_on_plane;
  std::vector<RandomScene> scenes = MakeScenes(options);
  for (RandomScene& scene : scenes) {
    CalibrationProblem& problem = scene.problem;
    if (spec.needs.pairs_3d3d == 0) problem.pairs_3d3d.clear();
    if (spec.needs.pairs_2d3d == 0) problem.pairs_2d3d.clear();
    if (spec.needs.points_per_set == 0) problem.point_sets = {};
    if (!spec.is_global) problem.initial_cam_from_lidar = Rigid3d{};
  }
  return scenes;
}

void Solve(benchmark::State& state, const SolverPtr& solver) {
  const std::vector<RandomScene> scenes =
      ScenesFor(solver->spec(), static_cast<int>(state.range(0)));
  for (const RandomScene& scene : scenes) {
    const Expected<SolveReport> report = solver->Solve(scene.problem);
    if (!report) return state.SkipWithError(report.error().message.c_str());
    if (!CheckPose(state, report->cam_from_lidar, scene.cam_from_lidar, kTolerance)) return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(solver->Solve(scenes[next].problem));
    next = next + 1 < scenes.size() ? next + 1 : 0;
  }
}

int LeastPairs(const DataNeeds& needs) {
  return std::max({needs.pairs_3d3d, needs.pairs_2d3d, needs.points_per_set});
}

void RegisterAll() {
  const SolverRegistry registry = BuiltinSolvers();
  for (const SolverEntry& entry : registry.entries()) {
    const Expected<SolverPtr> solver = registry.Make(entry.example);
    if (!solver) continue;
    auto* benchmark = benchmark::RegisterBenchmark(
        ("solve/" + (*solver)->spec().name).c_str(),
        [solver = *solver](benchmark::State& state) { Solve(state, solver); });
    for (const int pairs : {8, 20, 100, 1000}) {
      if (pairs >= LeastPairs((*solver)->spec().needs)) benchmark->Arg(pairs);
    }
  }
}

}  // namespace
}  // namespace sextant::bench

int main(int argc, char** argv) {
  sextant::bench::RegisterAll();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
