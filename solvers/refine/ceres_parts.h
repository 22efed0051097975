// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include "solvers/refine/refine_ceres.h"

namespace sextant {

/// A loss to be owned by a ceres::Problem; null for plain least squares.
ceres::LossFunction* NewLoss(const RobustLoss& loss);

ceres::Solver::Options CeresOptions(const RefineLimits& limits);

RefineOutcome OutcomeOf(ceres::TerminationType termination);

/// By how much the variance of an M-estimate exceeds the inverse of sum rho' J^T J. With w = rho'
/// at the squares s of the residuals of k numbers each, its covariance is
///   E[w^2 s / k] / E[w + 2 w' s / k]^2 (sum J^T J)^-1
/// (Huber 1981, section 6.3). The means are those of the residuals, so that outliers count: each
/// pulls at the pose as far as the loss lets it, and adds hardly any information.
class LossVariance {
 public:
  /// `rho`: rho, rho', rho'' at `squared`, of a residual of `rows` numbers.
  void Add(double squared, int rows, const double rho[3]);

  /// `unknowns`: numbers that were fitted. At least 1: of true pairs alone, the inverse of
  /// sum rho' J^T J is conservative, and the means of few residuals are uncertain.
  double Factor(double unknowns) const;

 private:
  double rows_ = 0.0;
  double weights_ = 0.0;  // sum k w
  double pulls_ = 0.0;    // sum w^2 s
  double slopes_ = 0.0;   // sum k w + 2 w' s
};

}  // namespace sextant
