// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/rig/solve_rig.h"

namespace sextant {

/// The information of one observation on the board's pose.
struct BoardInformation {
  std::size_t placement = 0;
  std::size_t sensor = 0;
  Rigid3d sensor_from_board;
  /// On the board's (dphi, dt) along its own axes, about its centre: of the whole observation, at
  /// the estimated noise.
  Matrix6d in_board = Matrix6d::Zero();
};

/// The information of every observation at an estimate, in which all sensors are connected. Of an
/// observation, those kinds of residuals are left out that cannot be evaluated there. Requires a
/// problem as RigModelOf does.
std::vector<BoardInformation> BoardInformationOf(const RigProblem& problem,
                                                 const RigEstimate& estimate);

}  // namespace sextant
