// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

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

  double full, none, scale, mu;
};

/// The mu at which the surrogate is convex at the largest residual; 0 if that is an inlier's.
double FirstGncMu(double largest_squared, double max_squared);

/// The weights are settled when none is further than this from 0 or 1.
inline constexpr double kGncBinary = 1e-3;

struct GncSchedule {
  double max_squared = 0.0;
  double mu_factor = 1.4;
  int max_iterations = 200;
};

struct GncPose {
  Rigid3d cam_from_lidar;
  int iterations = 0;
};

/// Graduated non-convexity on isotropic pairs from `start`, least squares on all of them: each
/// least squares of weighed pairs is closed, one pass over the pairs. None where weights leave a
/// turn free. The poses are those of FitKabsch, whether or not it would call them mirrored.
std::optional<GncPose> AnnealInColumns(const PairColumns& pairs, const Rigid3d& start,
                                       const GncSchedule& schedule);

}  // namespace sextant
