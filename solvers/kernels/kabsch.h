// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The least-squares rigid transform, and the residual of the best reflection.
struct KabschFit {
  Rigid3d b_from_a;
  double sum_squares = 0.0;  ///< sum_i w_i |b_i - R a_i - t|^2 at the optimum.
  /// The same for the best R with determinant -1, to 1e-7 of sum_i w_i (|a_i|^2 + |b_i|^2) about
  /// the means: far smaller where one set mirrors the other.
  double mirrored_sum_squares = 0.0;
};

/// A fit or the reason why there is none, without a message: searches discard most of them.
using KabschOutcome = tl::expected<KabschFit, ErrorCode>;

/// argmin over R in SO(3), t of sum_i w_i |b_i - R a_i - t|^2, in closed form.
///
/// The unit quaternion of R is the eigenvector of the largest eigenvalue of Horn's symmetric 4x4
/// matrix, so R is a rotation by construction (Horn 1987, JOSA A 4). The paper's eq. 12 to 18 give
/// the same by an SVD with a corrected sign of the determinant (Kabsch 1976, Umeyama 1991).
///
/// Shapes: equally many points [m] in both frames, at least 3; weights > 0, as many, or empty for
/// equal weights. Coplanar sets are fine.
/// Errors: kTooFewPairs; kDegenerate (collinear or coincident); kMirrored (a reflection fits five
/// times better than any rotation).
Expected<KabschFit> FitKabsch(std::span<const Eigen::Vector3d> points_in_b,
                              std::span<const Eigen::Vector3d> points_in_a,
                              std::span<const double> weights = {});

}  // namespace sextant
