// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "eval/synthetic/simulate_views.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// A rig that is simulated at the level of raw observations of one board at several moments.
struct RigSimulation {
  std::uint64_t seed = 1;
  int cameras = 3;  ///< "cam_0" and so on, which look along the rig's x axis.
  int lidars = 2;   ///< "lidar_0" and so on.
  int moments = 12;
  /// Probability that a sensor takes part in a moment. At least two do.
  double takes_part = 1.0;
  /// Noise, LiDAR and board; its seed and its number of views are not used.
  ViewSimulation sensors{};
};

struct SimulatedRig {
  RigProblem problem;  ///< Cameras before LiDARs.
  std::vector<Rigid3d> sensor_from_rig;
  std::vector<Rigid3d> rig_from_board;  ///< One for each placement.

  Rigid3d TrueBetween(std::size_t a, std::size_t b) const {
    return sensor_from_rig[a] * sensor_from_rig[b].Inverse();
  }
};

/// The same seed gives the same bytes. Requires two sensors and one moment at least.
SimulatedRig SimulateRig(const RigSimulation& simulation);

}  // namespace sextant
