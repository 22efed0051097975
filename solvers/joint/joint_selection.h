// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/joint/joint_noise.h"
#include "solvers/refine/refine_ceres.h"

namespace sextant {

/// Which observations of a view are used; shapes as in its terms.
struct JointViewSelection {
  std::vector<bool> printed;
  std::vector<bool> face;
  std::vector<bool> edges;

  /// Whether both sensors contribute.
  bool IsUsed() const;
  void Clear();

  friend bool operator==(const JointViewSelection&, const JointViewSelection&) = default;
};
using JointSelection = std::vector<JointViewSelection>;

/// Observations within `sigmas` times the noise. A view that lacks one of the sensors has none, as
/// it carries no information on the extrinsic.
JointSelection SelectWithin(const std::vector<BoardViewResiduals>& residuals,
                            const JointNoise& noise, double sigmas);

/// A robust loss for each kind of observation. A BoardPoints of n points counts as one observation,
/// with its norm relative to the mean norm sqrt(2 n), but with the scatter of a single point.
struct JointLosses {
  RobustLoss printed;
  RobustLoss face;
  RobustLoss edges;
  RobustLoss link;
};

/// The weights of iteratively reweighted least squares: 1 / noise, times the root of the loss's
/// slope at the residual (kNone, kHuber and kCauchy), for what is selected; 0 for all else.
std::vector<JointWeights> WeightsOf(const JointModel& model, const JointState& state,
                                    const std::vector<BoardViewResiduals>& residuals,
                                    const JointSelection& selection, const JointNoise& noise,
                                    const JointLosses& losses);

}  // namespace sextant
