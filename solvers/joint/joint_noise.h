// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "solvers/joint/joint_information.h"

namespace sextant {

/// The level of each kind of error.
struct JointNoise {
  double printed = 1.0;  ///< Standard deviation over the stated one, as the next two.
  double face = 1.0;
  double edges = 1.0;
  double out_of_plane_m =
      0.0;  ///< Sigma of what shifts all returns of a view together; see LinkError.
  double in_plane_m = 0.0;
  double rings = 1.0;  ///< Standard deviation of the rings' offsets over that of their prior.
};

/// Shift of the views where the sensor has none: so small that it does not change an answer.
inline constexpr double kNoShift_m = 2e-6;

/// From the medians of the absolute residuals, robust to nearly half of the data being outliers;
/// the shifts are those of `before`.
JointNoise MedianNoise(const std::vector<BoardViewResiduals>& residuals, const JointNoise& before);

/// Scales the shifts of the views by the median contradiction of the views.
JointNoise WithMedianShift(const std::vector<ViewSums>& sums, const JointNoise& before);

/// Variance components (Helmert; Foerstner 1979): each kind's variance times the squares of its
/// residuals over their redundancy, with the stated level as a prior that weighs as ten residuals
/// (`shift_m` and the offsets of rings: as four). `before`: the noise of the linearisation.
/// Iterated to its fixed point, this is the restricted maximum likelihood.
JointNoise EstimateNoise(const std::vector<ViewSums>& sums, const KindSum& rings,
                         const JointNoise& before, double shift_m);

bool IsSameNoise(const JointNoise& a, const JointNoise& b);

}  // namespace sextant
