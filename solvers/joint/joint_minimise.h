// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/joint/joint_problem.h"

namespace sextant {

struct JointMinimum {
  JointState state;
  JointSystem system;  ///< At that state.
  int iterations = 0;
  bool converged = false;  ///< The last step of every pose is under step_tolerance [rad, m].
};

/// argmin over the extrinsic, every board's pose and the other unknowns of 1/2 sum rho(|r_i|^2), by
/// LevenbergMarquardt. Views share only few unknowns: each board's pose is eliminated by its own
/// 6x6 block, so that an iteration is linear in the number of views (the Schur complement trick of
/// bundle adjustment; Triggs et al. 2000). Not by Ceres, whose residual blocks cost a virtual call
/// and an allocation for each return of the LiDAR; a test compares the two.
///
/// Requires a start at which every observation has a residual (Linearise).
JointMinimum MinimiseJointly(const std::vector<JointView>& views, const JointUnknowns& unknowns,
                             const JointLosses& losses, const JointState& start, int max_iterations,
                             double step_tolerance);

/// The information of the shared unknowns with the boards' poses eliminated. Directions of a
/// board's pose that its view does not determine contribute nothing.
Eigen::MatrixXd SharedInformation(const JointSystem& system);

}  // namespace sextant
