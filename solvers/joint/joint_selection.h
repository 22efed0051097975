// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/joint/joint_problem.h"

namespace sextant {

/// Which observations of a view are used; shapes as in its terms.
struct JointViewSelection {
  std::vector<bool> printed;
  std::vector<bool> face;
  std::vector<bool> edges;

  friend bool operator==(const JointViewSelection&, const JointViewSelection&) = default;
};
using JointSelection = std::vector<JointViewSelection>;

/// The ratio of the noise of each kind to the stated one: the median of the absolute whitened
/// residuals over that of a normal distribution, at least 1. Robust to nearly half of the data
/// being outliers.
struct JointNoise {
  double printed = 1.0;
  double face = 1.0;
  double edges = 1.0;
};

/// Whitened residuals of every view's observations at a state.
std::vector<BoardViewResiduals> JointResidualsAt(const std::vector<JointView>& views,
                                                 const JointUnknowns& unknowns,
                                                 const JointState& state);

JointNoise NoiseOf(const std::vector<BoardViewResiduals>& residuals);

/// All observations with a defined residual.
JointSelection SelectSeen(const std::vector<BoardViewResiduals>& residuals);
/// Those within `sigmas` times the estimated noise.
JointSelection SelectWithin(const std::vector<JointView>& views,
                            const std::vector<BoardViewResiduals>& residuals,
                            const JointNoise& noise, double sigmas);

/// The views, restricted to the selected observations.
std::vector<JointView> Selected(const std::vector<JointView>& views,
                                const JointSelection& selection);

}  // namespace sextant
