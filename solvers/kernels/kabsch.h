// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The rigid transform of least squares and what its spectrum says of the data.
struct KabschFit {
  Rigid3d b_from_a;
  double sum_squares = 0.0;  ///< sum_i w_i |b_i - R a_i - t|^2 at the optimum.
  /// The same over R with determinant -1, to 1e-7 of sum_i w_i (|a_i|^2 + |b_i|^2) about the means:
  /// far smaller where one set mirrors the other.
  double mirrored_sum_squares = 0.0;
};

/// A fit or why there is none, without a message: for searches, which discard most unread.
using KabschOutcome = tl::expected<KabschFit, ErrorCode>;

/// argmin over R in SO(3), t of sum_i w_i |b_i - R a_i - t|^2, in closed form.
///
/// The unit quaternion of R is the eigenvector of the largest eigenvalue of Horn's symmetric 4x4
/// matrix, so R is a rotation by construction (the paper's eq. 12 to 18 reach the same through an
/// SVD with the sign of its determinant put right: Kabsch 1976, Umeyama 1991; Horn 1987, JOSA A 4).
///
/// Shapes: equally many points [m] in both frames, at least 3; weights > 0, as many, or empty for
/// equal weights. Coplanar sets are fine.
/// Errors: kTooFewPairs; kDegenerate (collinear or coincident); kMirrored (a reflection fits five
/// times better than any rotation).
Expected<KabschFit> FitKabsch(std::span<const Eigen::Vector3d> points_in_b,
                              std::span<const Eigen::Vector3d> points_in_a,
                              std::span<const double> weights = {});

}  // namespace sextant
