// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"
#include "solvers/kernels/pair_columns.h"

namespace sextant {

/// The weight that minimises the graduated surrogate of truncated least squares at r^2 = squared:
/// 1 up to `full`, 0 from `none` on, sqrt(scale / squared) - mu between (Yang et al. 2020, eq. 14).
struct GncWeight {
  GncWeight(double max_squared, double convexity)
      : full(convexity / (convexity + 1.0) * max_squared),
        none((convexity + 1.0) / convexity * max_squared),
        scale(max_squared * convexity * (convexity + 1.0)),
        mu(convexity) {}

  /// 0 where `squared` is not a number.
  double At(double squared) const {
    if (squared <= full) return 1.0;
    if (!(squared < none)) return 0.0;
    return std::sqrt(scale / squared) - mu;
  }

  double full, none, scale, mu;
};

struct GncReweighting {
  /// The largest distance of a weight from 0 or 1, or change of a weight, whichever is larger.
  double unsettled = 0.0;
  /// Least squares on the weighted pairs, where it has a closed form and determines a pose.
  std::optional<Rigid3d> fit;
};

/// The largest finite r_i^2; 0 where there is none.
double LargestSquaredOf(const PairColumns& pairs, const Rigid3d& cam_from_lidar);

/// Replaces the weights by those at the pose and fits the weighted pairs, in one pass. The fit is
/// that of FitKabsch, also where FitKabsch calls the pairs mirrored.
/// Shape: pairs.padded() weights, in the order of the columns.
GncReweighting ReweightColumns(const PairColumns& pairs, const Rigid3d& cam_from_lidar,
                               const GncWeight& weight_of, std::span<double> weights);

}  // namespace sextant
