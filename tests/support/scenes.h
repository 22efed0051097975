// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "eval/synthetic/random_scene.h"
#include "eval/synthetic/simulate_views.h"

namespace sextant::test {

using PairScene = RandomScene;
using SceneOptions = RandomSceneOptions;

inline PairScene MakeScene(const SceneOptions& options, Random& random) {
  return MakeRandomScene(options, random);
}

/// A scene of raw board views with four pairs each: exact if no noise is requested, else with the
/// noise of SimulateViews. A third of its usual returns, for the time.
inline PairScene MakeBoardScene(const SceneOptions& options, Random& random) {
  const bool exact = options.sigma_m == 0.0 && options.sigma_px == 0.0;
  const int views = (options.pairs + kCornersPerBoard - 1) / kCornersPerBoard;
  SimulatedViews session =
      SimulateViews(
          {.seed = random.Bits(), .views = views, .azimuth_step_deg = 0.6, .exact = exact})
          .value();
  const auto pairs = static_cast<std::size_t>(options.pairs);
  session.problem.pairs_3d3d.resize(pairs);
  session.problem.pairs_2d3d.resize(pairs);
  return {std::move(session.problem), session.true_cam_from_lidar};
}

}  // namespace sextant::test
