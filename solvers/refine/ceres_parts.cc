// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/ceres_parts.h"

#include <algorithm>

#include "solvers/refine/barron_loss.h"

namespace sextant {

ceres::LossFunction* NewLoss(const RobustLoss& loss) {
  switch (loss.kind) {
    case LossKind::kNone:
      return nullptr;
    case LossKind::kHuber:
      return new ceres::HuberLoss(loss.scale);
    case LossKind::kCauchy:
      return new ceres::CauchyLoss(loss.scale);
    case LossKind::kTukey:
      return new ceres::TukeyLoss(loss.scale);
    case LossKind::kBarron:
      return new BarronLoss(loss.shape, loss.scale);
  }
  return nullptr;
}

ceres::Solver::Options CeresOptions(const RefineLimits& limits) {
  ceres::Solver::Options options;
  options.max_num_iterations = limits.max_iterations;
  options.parameter_tolerance = limits.step_tolerance;
  options.function_tolerance = 0.0;
  options.gradient_tolerance = 0.0;
  options.linear_solver_type = ceres::DENSE_QR;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

RefineOutcome OutcomeOf(ceres::TerminationType termination) {
  if (termination == ceres::CONVERGENCE) return RefineOutcome::kConverged;
  if (termination == ceres::NO_CONVERGENCE) return RefineOutcome::kMaxIterations;
  return RefineOutcome::kStalled;
}

void LossVariance::Add(double squared, int rows, const double rho[3]) {
  rows_ += rows;
  weights_ += rows * rho[1];
  pulls_ += rho[1] * rho[1] * squared;
  slopes_ += rows * rho[1] + 2.0 * rho[2] * squared;
}

double LossVariance::Factor(double unknowns) const {
  // Losses that are bounded have a negative slope beyond their scale; where most residuals are
  // there, the pose is no minimum that a covariance describes.
  constexpr double kMinSlope = 0.1;
  if (!(rows_ > unknowns) || !(weights_ > 0.0)) return 1.0;
  const double slope = std::max(slopes_, kMinSlope * weights_) / rows_;
  const double variance = pulls_ / (rows_ - unknowns) / (slope * slope);
  return std::max(1.0, variance * weights_ / rows_);
}

}  // namespace sextant
