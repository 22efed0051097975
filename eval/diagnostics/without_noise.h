// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/calibration_problem.h"

namespace sextant {

/// The pairs with the noise that they show instead of the one that they state: where a sigma is
/// stated too small, good pairs look like outliers.
inline CalibrationProblem WithoutNoise(CalibrationProblem problem) {
  for (Pair3d3d& pair : problem.pairs_3d3d) {
    pair.sigma_m = 0.0;
    pair.covariance_in_cam.reset();
  }
  for (Pair2d3d& pair : problem.pairs_2d3d) pair.sigma_px = 0.0;
  return problem;
}

}  // namespace sextant
