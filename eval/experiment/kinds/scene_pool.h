// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/scene/scene_score.h"
#include "simulator/scene/everyday_scene.h"

namespace sextant {

/// Simulated pairs of everyday scenes by one rig, each of another scene.
struct ScenePool {
  Rigid3d cam_from_lidar;
  std::vector<ScenePair> pairs;
};

/// `count` scenes of a place, seen by a LiDAR of this model (empty: the place's own) and its camera
/// with the usual noise. The same arguments give the same pool, which callers in one process share.
/// Errors: those of the simulator and of MakeScenePair. Time: about 2 s a pair.
Expected<std::shared_ptr<const ScenePool>> PoolOf(EverydayPlace place,
                                                  const std::string& lidar_model, int count);

}  // namespace sextant
