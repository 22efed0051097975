// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ceres/ceres.h>

#include <Eigen/Core>
#include <string>

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

/// How far the residuals that a loss all but ignores (weights below kMinLossWeight) pull the answer
/// from where the others have it: the step d = (sum rho' J^T J)^-1 sum rho' J^T r of the others
/// alone. LossVariance takes their pulls for random. Those of outliers that lie mostly on one side,
/// as pixels anywhere in the image do, add up with their number, while the covariance shrinks.
class OutlierPull {
 public:
  explicit OutlierPull(int unknowns)
      : information_(Eigen::MatrixXd::Zero(unknowns, unknowns)),
        slope_(Eigen::VectorXd::Zero(unknowns)) {}

  template <class Jacobian, class Residual>
  void Add(const Jacobian& jacobian, const Residual& residual, double weight) {
    ++all_;
    if (weight < kMinLossWeight) return;
    ++near_;
    information_.noalias() += weight * jacobian.transpose() * jacobian;
    slope_.noalias() += weight * jacobian.transpose() * residual;
  }

  /// Adds what d shows beyond chance: (1 - k / D) d d^T for D = d^T C^-1 d above its mean k, the
  /// number of unknowns, so that C holds the shift. Nothing without outliers, or where the others
  /// determine no answer. True where chance hardly ever leaves so large a D.
  bool Widen(Eigen::Ref<Eigen::MatrixXd> covariance) const;

  /// For the sentence of an answer of which Widen was true.
  std::string Describe() const;

 private:
  Eigen::MatrixXd information_;
  Eigen::VectorXd slope_;
  int all_ = 0;
  int near_ = 0;
};

}  // namespace sextant
