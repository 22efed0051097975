// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/rig/rig_noise.h"
#include "solvers/rig/solve_rig.h"

namespace sextant {

/// The minimum over the observations that are used, and which these are.
struct RigAnswer {
  RigState state;
  Eigen::MatrixXd covariance;  ///< For the shared columns of RigLinearisation.
  RigSelection selection;
  RigNoise noise;
  RigUnits units;
  int iterations = 0;
};

/// See SolveRig. Errors: kDegenerate, kNoConvergence.
Expected<RigAnswer> SearchRig(const RigModel& model, const RigState& start,
                              const RigOptions& options);

}  // namespace sextant
