// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/joint/joint_options.h"
#include "solvers/joint/joint_selection.h"

namespace sextant {

/// The minimum over the inliers, and the selection of these.
struct JointAnswer {
  JointState state;
  Eigen::MatrixXd covariance;  ///< For (dphi, dt), then the shared numbers.
  JointSelection selection;    ///< One entry per view.
  JointNoise noise;
  std::vector<double> disagreement;  ///< Disagreements of the views; 0 of those left out.
  int iterations = 0;                ///< Total over all rounds.
};

/// First minimises with the robust losses, scaled by the noise, and with views that may be shifted;
/// then alternates least squares, the estimate of the noise and the selection of the observations
/// within `cut` of it and of the views that do not contradict the others (ContradictingViews),
/// until both stay the same. Without a cut, the answer is the minimum of the losses, and the noise
/// that of the medians. `shift_m`: the expected shift of the returns of one view. Errors:
/// kDegenerate (no view is left, or the views leave a direction of the pose undetermined),
/// kNoConvergence.
Expected<JointAnswer> SearchJointly(const JointModel& model, const JointState& start,
                                    double shift_m, const JointOptions& options);

}  // namespace sextant
