// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <optional>

#include "geometry/rigid3d.h"

namespace sextant {

/// The cheapest pose met by fitting to the inliers of the last fit and choosing them anew, `pose`
/// included. The squared threshold is four times as large in the first round and half that in each
/// next, so that a pair just outside is not lost for good; ends after `rounds`, where there is no
/// fit, or when the cost no longer falls. Source: Lebeda, Matas and Chum 2012.
///
/// cost(pose, most): of the pose; any number from `most` on where it is no less.
/// fit(pose, widening): the fit to the inliers of `pose` at that many times the squared threshold.
template <class Cost, class Fit>
Rigid3d OptimiseOnShrinkingInliers(const Rigid3d& pose, double cost_of_pose, int rounds,
                                   const Cost& cost, const Fit& fit) {
  Rigid3d best = pose;
  double best_cost = cost_of_pose;
  Rigid3d current = pose;
  double widening = 4.0;
  for (int round = 0; round < rounds; ++round) {
    const std::optional<Rigid3d> next = fit(current, widening);
    if (!next) break;
    current = *next;
    const double current_cost = cost(current, best_cost);
    const bool falls = current.IsFinite() && current_cost < best_cost;
    if (falls) {
      best = current;
      best_cost = current_cost;
    }
    if (widening == 1.0 && !falls) break;
    widening = std::max(1.0, 0.5 * widening);
  }
  return best;
}

}  // namespace sextant
