// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/joint/joint_minimise.h"
#include "solvers/joint/joint_options.h"
#include "solvers/joint/joint_selection.h"

namespace sextant {

/// The minimum over the inliers, and the selection of these.
struct JointAnswer {
  JointMinimum minimum;
  JointSelection selection;  ///< One entry per view.
  JointNoise noise;          ///< From all observations, at the answer.
  int iterations = 0;        ///< Total over all rounds.
};

/// First minimises with the robust losses, scaled by the noise estimated from the residuals; then
/// alternates least squares with the selection of the observations within `cut`, until the
/// selection stays the same. A view without printed points or without rays carries no information
/// and is dropped. Errors: kDegenerate (no view is left), kNoConvergence.
Expected<JointAnswer> SearchJointly(const std::vector<JointView>& views,
                                    const JointUnknowns& unknowns, const JointState& start,
                                    const JointOptions& options);

}  // namespace sextant
