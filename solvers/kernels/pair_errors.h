// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/calibration_problem.h"

namespace sextant {

struct PairErrors {
  double squares_m2 = 0.0;  ///< Sum of the squared residuals.
  double squares = 0.0;     ///< The same with each residual over its sigma, where it states one.
};

/// Residuals of 3D-3D pairs at a pose; covariances are not looked at. Writes the length [m] of
/// each. Shape: as many distances as pairs.
PairErrors MeasurePairs(std::span<const Pair3d3d> pairs, const Rigid3d& cam_from_lidar,
                        std::span<double> distances_m);

}  // namespace sextant
