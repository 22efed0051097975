// SPDX-License-Identifier: Apache-2.0
#include "bench/check.h"

#include <algorithm>
#include <cstdio>

namespace sextant::bench {

bool CheckPose(benchmark::State& state, const Rigid3d& answer, const Rigid3d& truth,
               const Tolerance& tolerance) {
  const PoseDistance off = DistanceBetween(answer, truth);
  if (off.rotation_rad <= tolerance.rotation_rad && off.translation_m <= tolerance.translation_m) {
    return true;
  }
  char message[160];
  std::snprintf(message, sizeof(message),
                "wrong: %.3g rad and %.3g m from the truth, allowed %.3g rad and %.3g m",
                off.rotation_rad, off.translation_m, tolerance.rotation_rad,
                tolerance.translation_m);
  state.SkipWithError(message);
  return false;
}

std::size_t SceneCount(std::int64_t points) {
  return static_cast<std::size_t>(std::clamp<std::int64_t>(2000 / points, 1, 64));
}

std::vector<RandomScene> MakeScenes(const RandomSceneOptions& options) {
  std::vector<RandomScene> scenes(SceneCount(options.pairs));
  Random random(1);
  for (RandomScene& scene : scenes) scene = MakeRandomScene(options, random);
  return scenes;
}

}  // namespace sextant::bench
