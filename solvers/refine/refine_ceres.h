// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/least_squares/refine_pose.h"

namespace sextant {

enum class LossKind { kNone, kHuber, kCauchy, kTukey, kBarron };

/// The cost 1/2 rho(s) of a pair with squared whitened residual s.
struct RobustLoss {
  LossKind kind = LossKind::kNone;
  double scale = 2.0;   ///< Sigmas.
  double shape = -2.0;  ///< For kBarron only; see BarronLoss.
};

/// As RefinePose, with a robust loss on each pair, by ceres::Problem. `cost` is
/// 1/2 sum rho(|r_i|^2) and `information` sum rho'(|r_i|^2) J_i^T J_i over the factor by which the
/// residuals show that the variance is larger (LossVariance): its inverse is the covariance.
RefinedPose RefinePoseWithCeres(const TermsView& terms, const Rigid3d& start,
                                const RobustLoss& loss, const RefineLimits& limits);

/// A pair with a smaller weight rho' is no inlier: it hardly affects the pose, and its
/// residual is not one of the noise.
inline constexpr double kMinLossWeight = 0.25;

/// Indices of the terms, points before pixels, whose weight rho'(|r_i|^2) at `pose` is at least
/// kMinLossWeight.
std::vector<int> WeightedTerms(const TermsView& terms, const Rigid3d& pose, const RobustLoss& loss);

/// Widens the covariance of a minimum of RefinePoseWithCeres by the shift that outliers make (see
/// OutlierPull). A sentence where chance does not explain that shift.
std::optional<std::string> AddOutlierPull(const TermsView& terms, const Rigid3d& pose,
                                          const RobustLoss& loss, Matrix6d& covariance);

/// The covariance of (dphi, dt) at `pose` under plain least squares by ceres::Covariance; none
/// where the information is singular. Slower than InvertSymmetric; tests compare the two.
std::optional<Matrix6d> CeresCovariance(const TermsView& terms, const Rigid3d& pose);

}  // namespace sextant
