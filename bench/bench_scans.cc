// SPDX-License-Identifier: Apache-2.0
// Registration of two scans of a room, 10 cm and 5 degrees apart. One thread. A hundred rooms are
// checked against the truth before one is timed.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <string>

#include "eval/extractors/scan_pairs.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant {
namespace {

constexpr int kRooms = 100;

// 64 rings of 1563 columns: 100,000 points.
LidarModel SixtyFourRings() {
  LidarModel model = *FindLidarModel("hdl64e");
  model.column_period_s = model.turn_period_s / 1563.0;
  return model;
}

LidarModel SixteenRings(bool ring_biases) {
  LidarModel model = *FindLidarModel("vlp16");
  if (!ring_biases) model.ring_bias_sigma_m = 0.0;
  return model;
}

Expected<CalibrationProblem> RoomProblem(const LidarModel& model, int room, Rigid3d& truth) {
  return ScanRoomTwice(model, static_cast<std::uint64_t>(room)).map([&truth](const ScanPair& pair) {
    truth = pair.target_from_source;
    CalibrationProblem problem;
    problem.point_sets = {.in_cam = pair.in_target, .in_lidar = pair.in_source};
    return problem;
  });
}

struct Checked {
  std::vector<double> errors_deg;  ///< Ascending.
  CalibrationProblem first;
};

Checked CheckRooms(const Solver& solver, const LidarModel& model) {
  Checked checked;
  for (int room = 0; room < kRooms; ++room) {
    Rigid3d truth;
    const Expected<CalibrationProblem> problem = RoomProblem(model, room, truth);
    if (!problem) continue;
    const Expected<SolveReport> report = solver.Solve(*problem);
    if (room == 0) checked.first = *problem;
    if (!report) continue;
    const PoseDistance error = DistanceBetween(report->cam_from_lidar, truth);
    checked.errors_deg.push_back(error.rotation_rad * 180.0 / std::numbers::pi);
  }
  std::ranges::sort(checked.errors_deg);
  return checked;
}

// Times room 0 if every room is within most_deg.
void Rooms(benchmark::State& state, const char* name, const LidarModel& model, double most_deg) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make("icp(match=projective,init=identity)");
  if (!solver) return state.SkipWithError(solver.error().message.c_str());
  // Kept, as each repetition of the benchmark calls this again.
  static std::map<std::string, Checked> known;
  if (!known.contains(name)) known[name] = CheckRooms(**solver, model);
  const Checked& checked = known[name];
  if (checked.errors_deg.size() < kRooms) return state.SkipWithError("a room has no result");
  state.counters["median_deg"] = checked.errors_deg[kRooms / 2];
  state.counters["worst_deg"] = checked.errors_deg.back();
  state.counters["points"] = static_cast<double>(checked.first.point_sets.in_cam.size());
  if (checked.errors_deg.back() > most_deg) return state.SkipWithError("a room's pose is wrong");
  for (auto _ : state) benchmark::DoNotOptimize((*solver)->Solve(checked.first));
}

BENCHMARK_CAPTURE(Rooms, rings_16, "16", SixteenRings(false), 0.025)
    ->Name("rooms/sextant/16")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Rooms, rings_16_biased, "16 biased", SixteenRings(true), 0.025)
    ->Name("rooms/sextant_biased_rings/16")
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(Rooms, rings_64, "64", SixtyFourRings(), 0.008)
    ->Name("rooms/sextant/64")
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace sextant

BENCHMARK_MAIN();
