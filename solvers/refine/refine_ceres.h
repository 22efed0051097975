// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "solvers/least_squares/refine_pose.h"

namespace sextant {

enum class LossKind { kNone, kHuber, kCauchy, kTukey, kBarron };

/// What a pair of squared whitened residual s costs: 1/2 rho(s).
struct RobustLoss {
  LossKind kind = LossKind::kNone;
  double scale = 2.0;   ///< Sigmas.
  double shape = -2.0;  ///< Of barron only; see BarronLoss.
};

/// As RefinePose, with a robust loss on each pair, by ceres::Problem. `cost` is
/// 1/2 sum rho(|r_i|^2) and `information` sum rho'(|r_i|^2) J_i^T J_i.
RefinedPose RefinePoseWithCeres(const TermsView& terms, const Rigid3d& start,
                                const RobustLoss& loss, const RefineLimits& limits);

/// What ceres::Covariance says of (dphi, dt) at `pose` under plain least squares; none where the
/// information is singular. Slower than InvertInformation and there to check it.
std::optional<Matrix6d> CeresCovariance(const TermsView& terms, const Rigid3d& pose);

}  // namespace sextant
