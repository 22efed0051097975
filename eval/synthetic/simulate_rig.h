// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "eval/synthetic/simulate_views.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// Time between two observations by one sensor of a board that moves.
inline constexpr double kScanInterval_s = 0.1;

/// A rig that is simulated at the level of raw observations of one board at several moments.
struct RigSimulation {
  std::uint64_t seed = 1;
  int cameras = 3;  ///< "cam_0" and so on, which look along the rig's x axis.
  int lidars = 2;   ///< "lidar_0" and so on.
  int moments = 12;
  /// Probability that a sensor takes part in a moment. At least two do.
  double takes_part = 1.0;
  /// Speed of the board in each moment, in a random direction; 0: it stands still, and observations
  /// have no times. Otherwise every sensor sees it three times, kScanInterval_s apart, from a time
  /// of its own on.
  double speed_m_s = 0.0;
  double turn_rad_s = 0.5;         ///< About a random axis, where the board moves.
  double acceleration_m_s2 = 0.0;  ///< In a random direction, where the board moves.
  /// How far the clock of each sensor is ahead, cameras before LiDARs; empty: not at all.
  std::vector<double> clock_ahead_s{};
  /// Noise, LiDAR and board; its seed and its number of views are not used.
  ViewSimulation sensors{};
};

struct SimulatedRig {
  RigProblem problem;  ///< Cameras before LiDARs.
  std::vector<Rigid3d> sensor_from_rig;
  std::vector<Rigid3d> rig_from_board;  ///< One for each placement, at the middle of its time.

  Rigid3d TrueBetween(std::size_t a, std::size_t b) const {
    return sensor_from_rig[a] * sensor_from_rig[b].Inverse();
  }
};

/// The same seed gives the same bytes. Requires two sensors and one moment at least.
SimulatedRig SimulateRig(const RigSimulation& simulation);

}  // namespace sextant
