// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/lanes.h"
#include "solvers/pair_columns.h"
#include "solvers/pair_lanes.h"

namespace sextant {

/// First columns of the two frames.
inline constexpr int kCamColumn = 0;
inline constexpr int kLidarColumn = 3;
inline constexpr int kVarianceColumn = 6;
inline constexpr int kInverseVarianceColumn = 7;

/// Eight points of the frame whose columns begin at `first`.
SEXTANT_INLINE Point3<Lanes> PointsAt(const PairColumns& pairs, int first, std::size_t place) {
  return {LoadLanes(pairs.Column(first) + place), LoadLanes(pairs.Column(first + 1) + place),
          LoadLanes(pairs.Column(first + 2) + place)};
}

SEXTANT_INLINE Point3<double> PointOf(const PairColumns& pairs, int first, std::size_t place) {
  return {pairs.Column(first)[place], pairs.Column(first + 1)[place],
          pairs.Column(first + 2)[place]};
}

}  // namespace sextant
