// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/minimise_pose.h"

namespace sextant {

struct RefinedPose {
  Rigid3d cam_from_lidar;
  double cost = 0.0;  ///< 1/2 sum of squared whitened residuals.
  /// J^T J at the pose, or within 1e-6 rad and m of it without RefineLimits::wants_information.
  Matrix6d information = Matrix6d::Zero();
  int iterations = 0;  ///< Times the residuals were differentiated.
  RefineOutcome outcome = RefineOutcome::kMaxIterations;
};

/// argmin over SE(3) of 1/2 sum |r_i|^2 over the terms of both kinds, near `start`, never worse
/// than it beyond rounding.
///
/// MinimisePose with analytic derivatives, d(R p + t) = -[R p]x dphi + dt; pixels of a pinhole
/// camera eight at a time (pixel_sums.h). Allocates nothing. About 1 us for 20 pixels.
/// Degenerate data (a singular J^T J) is left to the caller: see InvertSymmetric.
RefinedPose RefinePose(const TermsView& terms, const Rigid3d& start, const RefineLimits& limits);

/// Covariance of (dphi, dt) at a least-squares minimum: InvertSymmetric of J^T J, times the
/// residual variance 2 cost / (residuals - 6) where the noise was only assumed. None where there
/// are no redundant residuals, or the information is singular.
std::optional<Matrix6d> LeastSquaresCovariance(const PairTerms& terms, const Matrix6d& information,
                                               double cost);

}  // namespace sextant
