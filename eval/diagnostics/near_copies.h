// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// The physical point of each pair, numbered from 0 by first appearance, where a scene at rest was
/// measured several times: most points have two or more pairs, which are far closer together, in
/// both sensors, than the points are, and what remains within a point is unrelated between the
/// sensors. Corners of small boards far apart form such groups, too, but there the sensors agree on
/// the differences. Empty where the pairs are not of this kind or where that cannot be told.
///
/// Shapes: in_lidar 3 x n, observed 2 x n (pixels) or 3 x n, ids n. Independent of the units.
/// Source: leader clustering (Hartigan 1975) at a few multiples of the median distance of nearest
/// neighbours, each with a search for the gap around the means. Most pairs without copies are told
/// by a sample of 500; else the time is at most n times the number of pairs in a thin slab.
std::vector<int> PointsOfNearCopies(const Eigen::Matrix3Xd& in_lidar,
                                    const Eigen::MatrixXd& observed, std::span<const PairId> ids);

}  // namespace sextant
