// SPDX-License-Identifier: Apache-2.0
// scene_robustness NAME POSE CAMERA IMAGES CLOUDS PAIRS DRAWS [ALTERATION]: how `sextant check`
// judges a recording of known calibration that is altered, one row for each alteration and offset
// of the given pose. ALTERATION: only those whose name contains it. Each answer in full goes to
// standard error.
#include <fmt/core.h>

#include <array>
#include <cstdio>
#include <cstdlib>

#include "base/median.h"
#include "base/units.h"
#include "bench/scene/scene_alterations.h"
#include "calibrate/scene/pose_check.h"

namespace sextant {
namespace {

constexpr CheckLimits kRowLimits = {.rotation_rad = 0.5 * kRadPerDeg, .translation_m = 0.08};

struct Counts {
  std::array<int, 3> states{};
  std::vector<double> held_out;
  std::vector<double> rotations_deg;
};

Counts CountStates(const std::vector<ScenePair>& pairs, std::size_t count, const Rigid3d& truth,
                   const PoseOffset& offset, int draws) {
  Random random(31);
  Counts counts;
  for (int draw = 0; draw < draws; ++draw) {
    const std::vector<ScenePair> some = SomeOf(pairs, count, random);
    const Rigid3d given = OffBy(truth, offset, random);
    const SceneFit fit = SearchScenes(some, given);
    const PoseCheck check = CheckScenes(fit, given, kRowLimits);
    ++counts.states[static_cast<std::size_t>(check.state)];
    counts.held_out.push_back(fit.held_out);
    counts.rotations_deg.push_back(DistanceBetween(fit.cam_from_lidar, truth).rotation_rad /
                                   kRadPerDeg);
    fmt::print(stderr, "{:.1f} | {} {} held out {:.1f} halves {:.0f} free {:.2f}: {}: {}\n",
               offset.rotation_deg, fit.edges, fit.scenes, fit.held_out, fit.halves_distance,
               (fit.free_score - fit.score) / fit.chance_sigma, ToString(check.state),
               check.reason);
  }
  return counts;
}

int Main(const RawRecording& recording, std::size_t count, int draws, const std::string& only) {
  fmt::print(
      "| recording | pairs | altered | off by | still valid | moved | cannot tell | held out | "
      "refined, off by |\n|:--|--:|:--|--:|--:|--:|--:|--:|--:|\n");
  for (const SceneAlteration& alteration : SceneAlterations()) {
    if (alteration.name.find(only) == std::string::npos) continue;
    RawRecording altered = recording;
    alteration.alter(altered);
    const std::vector<ScenePair> pairs = ScenePairsOf(altered);
    for (const double off_deg : {0.0, 1.0}) {
      fmt::print(stderr, "-- {}\n", alteration.name);
      Counts counts =
          CountStates(pairs, count, altered.cam_from_lidar, {.rotation_deg = off_deg}, draws);
      fmt::print("| {} | {} | {}{} | {:g} deg | {} | {} | {} | {:.1f} | {:.2f} deg |\n",
                 recording.name, count, alteration.name, alteration.must_refuse ? " (wrong)" : "",
                 off_deg, counts.states[0], counts.states[1], counts.states[2],
                 UpperMedian(counts.held_out), UpperMedian(counts.rotations_deg));
      std::fflush(stdout);
    }
  }
  return 0;
}

}  // namespace
}  // namespace sextant

int main(int argc, char** argv) {
  if (argc < 8) return 2;
  return sextant::Main(sextant::ReadRecording(argv[1], argv[2], argv[3], argv[4], argv[5]),
                       static_cast<std::size_t>(std::atoi(argv[6])), std::atoi(argv[7]),
                       argc > 8 ? argv[8] : "");
}
