// SPDX-License-Identifier: Apache-2.0
// Every solver of the catalogue through its interface, with the example of its entry. New solvers
// are timed here without any change.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdio>
#include <optional>
#include <string>

#include "bench/check.h"
#include "eval/metrics/bounds.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant::bench {
namespace {

// A chi-square variable with 6 degrees of freedom exceeds this once in a million, so only wrong
// results do. A minimal solver can legitimately be far from the truth (p3p over 0.1 m in 3 percent
// of these scenes), so the error is measured in units of its own covariance, which the contract
// tests verify, or of the Cramer-Rao bound if there is none.
constexpr double kMaxSquaredSigmas = 38.26;

bool CheckAnswer(benchmark::State& state, const Solver& solver, const SolveReport& report,
                 const RandomScene& scene) {
  std::optional<Matrix6d> covariance = report.covariance;
  if (!covariance) {
    const Expected<Matrix6d> bound = CramerRaoBound(scene.problem, scene.cam_from_lidar);
    if (bound) covariance = *bound;
  }
  if (!covariance) {
    state.SkipWithError("neither a covariance nor a bound to compare the error with");
    return false;
  }
  const Vector6d error = PoseDifference(report.cam_from_lidar, scene.cam_from_lidar);
  const Eigen::Vector3d shift = error.tail<3>();
  const double squared = solver.spec().estimates_rotation
                             ? SquaredMahalanobis(error, *covariance)
                             : SquaredMahalanobis<3>(shift, covariance->bottomRightCorner<3, 3>());
  if (squared <= kMaxSquaredSigmas) return true;
  char message[160];
  std::snprintf(message, sizeof(message),
                "wrong: %.3g squared sigmas from the truth, allowed %.4g (%.3g rad, %.3g m)",
                squared, kMaxSquaredSigmas, error.head<3>().norm(), shift.norm());
  state.SkipWithError(message);
  return false;
}

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
    if (!CheckAnswer(state, *solver, *report, scene)) return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(solver->Solve(scenes[next].problem));
    next = next + 1 < scenes.size() ? next + 1 : 0;
  }
}

int MinPairs(const DataNeeds& needs) {
  return std::max({needs.pairs_3d3d, needs.pairs_2d3d, needs.points_per_set});
}

void RegisterAll() {
  const SolverRegistry registry = BuiltinSolvers();
  for (const SolverEntry& entry : registry.entries()) {
    const Expected<SolverPtr> solver = registry.Make(entry.example);
    // Solvers of raw views need another kind of scene: bench_joint.
    if (!solver || (*solver)->spec().needs.board_views > 0) continue;
    auto* benchmark = benchmark::RegisterBenchmark(
        ("solve/" + (*solver)->spec().name).c_str(),
        [solver = *solver](benchmark::State& state) { Solve(state, solver); });
    for (const int pairs : {8, 20, 100, 1000}) {
      if (pairs >= MinPairs((*solver)->spec().needs)) benchmark->Arg(pairs);
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
