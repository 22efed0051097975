// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {

/// FitKabsch without messages.
KabschOutcome FitPoints(std::span<const Eigen::Vector3d> points_in_b,
                        std::span<const Eigen::Vector3d> points_in_a,
                        std::span<const double> weights);

/// What the moments of the pairs say of the fit besides the pose; all about the means.
struct KabschMoments {
  double weight = 0.0;            ///< sum w
  Eigen::Vector3d mean_in_lidar;  ///< Weighted.
  Eigen::Matrix3d cross;          ///< sum w l c^T of the points in the LiDAR and camera frames.
  Eigen::Matrix3d scatter;        ///< sum w l l^T
};

/// The fit of cam_from_lidar to pairs, weighed by IsotropicWeight.
KabschOutcome FitPairs(std::span<const Pair3d3d> pairs, KabschMoments& moments);

/// Covariance of (dphi, dt) of that fit where the variance of a coordinate of pair i is
/// `variance` / w_i: PropagateCovariance in closed form.
///
/// About the means the Hessian is H = tr(M) I - M of the rotation, with M = R cross, and (sum w) I
/// of the shift; the noise enters as G = tr(A) I - A, A = R scatter R^T. The covariance of the
/// rotation is H^-1 G H^-1.
Matrix6d KabschCovariance(const KabschMoments& moments, const Rigid3d& cam_from_lidar,
                          double variance);

/// The error that explains a code of KabschOutcome.
Error ExplainKabsch(ErrorCode code, std::size_t count);

}  // namespace sextant
