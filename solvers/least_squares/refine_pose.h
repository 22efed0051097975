// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/kernels/pair_terms.h"

namespace sextant {

struct RefineLimits {
  int max_iterations = 50;
  double step_tolerance = 1e-10;  ///< Largest last step: |dphi| [rad], |dt| / (1 + |t|) [m].
  /// Sums the information at the answer itself, which costs a pass over the terms.
  bool wants_information = true;
};

enum class RefineOutcome {
  kConverged,      ///< The next step is under the tolerance.
  kMaxIterations,  ///< Stopped by the limit.
  kStalled,        ///< No damping made the cost fall.
  kNotProjected,   ///< A point does not project at the start.
};

struct RefinedPose {
  Rigid3d cam_from_lidar;
  double cost = 0.0;  ///< 1/2 sum of squared whitened residuals.
  /// J^T J there; within 1e-6 rad and m of there where it is not wanted.
  Matrix6d information = Matrix6d::Zero();
  int iterations = 0;  ///< Times the residuals were differentiated.
  RefineOutcome outcome = RefineOutcome::kMaxIterations;
};

/// argmin over SE(3) of 1/2 sum |r_i|^2 over the terms of both kinds, near `start`, never worse
/// than it beyond rounding.
///
/// Levenberg-Marquardt (Marquardt 1963) on the 6 numbers of Perturb, derivatives by hand:
/// d(R p + t) = -[R p]x dphi + dt; pixels of a pinhole camera eight at a time (pixel_sums.h). Ends
/// with the step after which, shrinking as the last two did, the next is under the tolerance.
/// Allocates nothing. About 1 us for 20 pixels.
/// Degenerate data (a singular J^T J) is left to the caller: see InvertInformation.
RefinedPose RefinePose(const TermsView& terms, const Rigid3d& start, const RefineLimits& limits);

/// The inverse of J^T J; none where it is singular to 1e-13 after scaling to a unit diagonal, so
/// that the choice of units does not matter.
std::optional<Matrix6d> InvertInformation(const Matrix6d& information);

/// Covariance of (dphi, dt) at a least-squares minimum: InvertInformation, times the residual
/// variance 2 cost / (residuals - 6) where the noise was only assumed. None where there is no
/// residual to judge by, or the information is singular.
std::optional<Matrix6d> LeastSquaresCovariance(const PairTerms& terms, const Matrix6d& information,
                                               double cost);

}  // namespace sextant
