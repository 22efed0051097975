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

/// Moments of the pairs about their means, for the covariance of a fit.
struct KabschMoments {
  double weight = 0.0;            ///< sum w
  Eigen::Vector3d mean_in_lidar;  ///< Weighted mean.
  Eigen::Matrix3d cross;          ///< sum w l c^T of the points in the LiDAR and camera frames.
  Eigen::Matrix3d scatter;        ///< sum w l l^T
};

/// Fits cam_from_lidar to pairs with the weights IsotropicWeight.
KabschOutcome FitPairs(std::span<const Pair3d3d> pairs, KabschMoments& moments);

/// Covariance of (dphi, dt) of that fit where the variance of a coordinate of pair i is
/// `variance` / w_i: PropagateCovariance in closed form.
///
/// About the means the Hessian is H = tr(M) I - M for the rotation, with M = R cross, and (sum w) I
/// for the translation; the noise enters as G = tr(A) I - A, A = R scatter R^T. The covariance of
/// the rotation is H^-1 G H^-1.
Matrix6d KabschCovariance(const KabschMoments& moments, const Rigid3d& cam_from_lidar,
                          double variance);

/// The Error for a code of KabschOutcome.
Error ExplainKabsch(ErrorCode code, std::size_t count);

}  // namespace sextant
