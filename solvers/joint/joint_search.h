// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/joint/joint_minimise.h"
#include "solvers/joint/joint_options.h"
#include "solvers/joint/joint_selection.h"

namespace sextant {

/// The minimum over what is neither outlier nor unseen, and which observations that is.
struct JointAnswer {
  JointMinimum minimum;
  JointSelection selection;  ///< Of all views, in their order.
  JointNoise noise;          ///< Of all observations, at the answer.
  int iterations = 0;        ///< Of all rounds.
};

/// First with the robust losses, widened by the noise that the data shows and narrowed as it falls;
/// then least squares of what is within `cut`, again and again until that stays the same. A view
/// that is left without printed points or without rays says nothing and is left out whole.
/// Errors: kDegenerate (no view is left), kNoConvergence.
Expected<JointAnswer> SearchJointly(const std::vector<JointView>& views,
                                    const JointUnknowns& unknowns, const JointState& start,
                                    const JointOptions& options);

}  // namespace sextant
