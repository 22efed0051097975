// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/rig/rig_minimum.h"

namespace sextant {

/// Weighted squared residuals and what is expected of their sum.
struct RigSum {
  double squares = 0.0;
  double redundancy = 0.0;  ///< The rows' number less their leverages.
};

/// The covariance of a linearisation, with the placements eliminated, and the sums of its
/// residuals. O(rows + placements shared^2) time.
struct RigInformation {
  /// For the shared columns: (dphi, dt) of sensor_from_root of each sensor but the root, then the
  /// shared numbers.
  Eigen::MatrixXd covariance;
  std::vector<RigSum> sums;  ///< One for each of RigLinearisation::rows; for a shift's prior the
                             ///< rows out of the plane.
  std::vector<RigSum> in_plane;  ///< As many: of a shift's prior the rows in the plane, else 0.
};

/// None where a sensor's pose is undetermined.
std::optional<RigInformation> RigInformationOf(const RigLinearisation& at);

}  // namespace sextant
