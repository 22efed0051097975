// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "eval/synthetic/random_scene.h"
#include "geometry/rigid3d.h"

namespace sextant::bench {

/// How far from the truth an answer may be and still be worth timing.
struct Tolerance {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
};

/// Whether `answer` is the truth within the tolerance; otherwise marks the benchmark as failed and
/// says by how much, and the caller returns without timing.
bool CheckPose(benchmark::State& state, const Rigid3d& answer, const Rigid3d& truth,
               const Tolerance& tolerance);

/// How many different problems of `points` points to take in turn, so that no branch predictor
/// learns a single one: 64, and fewer where they would fill the caches.
std::size_t SceneCount(std::int64_t points);

/// As many scenes. The same options give the same scenes in every binary.
std::vector<RandomScene> MakeScenes(const RandomSceneOptions& options);

}  // namespace sextant::bench
