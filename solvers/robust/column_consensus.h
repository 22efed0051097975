// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/rigid3d.h"
#include "solvers/kernels/pair_columns.h"

namespace sextant {

/// The cheapest pose met by alternating FitInliers with choosing the inliers, generously at first:
/// OptimiseOnInliers of consensus.h in closed form.
Rigid3d OptimiseOnInliers(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                          double max_squared, int rounds = 20);

/// RandomAgreementProbability of consensus.h.
double RandomAgreementProbability(const PairColumns& pairs, double max_squared);

/// At most as many as `indices` has different pairs, and nearly as many.
int CountDistinctAtLeast(const PairColumns& pairs, std::span<const int> indices);

}  // namespace sextant
