// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "eval/synthetic/random_scene.h"
#include "geometry/rigid3d.h"

namespace sextant::bench {

/// Maximum error of a result that is timed.
struct Tolerance {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
};

/// Whether `answer` equals the truth within the tolerance. If not, marks the benchmark as failed
/// with the error, and the caller must return without timing.
bool CheckPose(benchmark::State& state, const Rigid3d& answer, const Rigid3d& truth,
               const Tolerance& tolerance);

/// Number of different problems of `points` points to cycle through, so that the branch predictor
/// does not learn a single one: 64, or fewer if they would fill the caches.
std::size_t SceneCount(std::int64_t points);

/// This number of scenes. The same options give the same scenes in every binary.
std::vector<RandomScene> MakeScenes(const RandomSceneOptions& options);

}  // namespace sextant::bench
