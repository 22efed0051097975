// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/joint/joint_problem.h"

namespace sextant {

/// Which observations of a view are used; as long as its terms.
struct JointViewSelection {
  std::vector<bool> printed;
  std::vector<bool> face;
  std::vector<bool> edges;

  friend bool operator==(const JointViewSelection&, const JointViewSelection&) = default;
};
using JointSelection = std::vector<JointViewSelection>;

/// By how much the noise of each kind is larger than stated: the median of the absolute whitened
/// residuals over that of a normal distribution, at least 1. Half of the data may be wrong.
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

/// All observations that have a residual.
JointSelection SelectSeen(const std::vector<BoardViewResiduals>& residuals);
/// Those of them within `sigmas` of the noise found.
JointSelection SelectWithin(const std::vector<JointView>& views,
                            const std::vector<BoardViewResiduals>& residuals,
                            const JointNoise& noise, double sigmas);

/// The views with the selected observations only.
std::vector<JointView> Selected(const std::vector<JointView>& views,
                                const JointSelection& selection);

}  // namespace sextant
