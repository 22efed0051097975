// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "geometry/rigid3d.h"
#include "io/problems/rig_yaml.h"
#include "io/results/rig_result.h"

namespace sextant {

/// Solves a rig, and every pair of its sensors alone as a check (the loop test): each pair's own
/// answer against that of all sensors, with time offsets in both or in neither. Runs on all cores;
/// the same input gives the same result on any number of them. `estimate_time`:
/// RigOptions::estimate_time. Progress: the stage of SolveRig, then "pairs of sensors". Errors:
/// those of SolveRig.
Expected<RigResult> CalibrateRig(const RigFile& rig, bool estimate_time = false,
                                 const ProgressCallback& progress = {});

/// A LiDAR and the cameras of rts.txt of the original package (io/problems/transform_list.h), each
/// of which has cam_from_lidar: "lidar", "camera_1", "camera_2" and so on, without uncertainty.
RigResult RigOfTransforms(const std::vector<Rigid3d>& cam_from_lidar);

}  // namespace sextant
