// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/ceres_parts.h"

#include <fmt/core.h>
#include <glog/logging.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "solvers/refine/barron_loss.h"

namespace sextant {

namespace {

// Ceres writes to the log of a program that has not set one up, which is its standard error, where
// it ends without an answer; our own messages state that.
void SilenceUnwantedLog() {
  static const bool is_silent = [] {
    const bool is_wanted = google::IsGoogleLoggingInitialized();
    if (!is_wanted) FLAGS_minloglevel = google::GLOG_FATAL;
    return !is_wanted;
  }();
  static_cast<void>(is_silent);
}

}  // namespace

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
  SilenceUnwantedLog();
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

bool OutlierPull::Widen(Eigen::Ref<Eigen::MatrixXd> covariance) const {
  if (near_ == all_) return false;
  const Eigen::LLT<Eigen::MatrixXd> others(information_);
  const Eigen::LLT<Eigen::MatrixXd> stated(covariance);
  if (others.info() != Eigen::Success || stated.info() != Eigen::Success) return false;
  const Eigen::VectorXd shift = others.solve(slope_);
  const double squared = shift.dot(stated.solve(shift));
  const auto unknowns = static_cast<double>(shift.size());
  if (!std::isfinite(squared) || squared <= unknowns) return false;
  covariance += (1.0 - unknowns / squared) * shift * shift.transpose();
  constexpr double kChance = 5.0;  // Standard deviations of chi-square above its mean.
  return squared > unknowns + kChance * std::sqrt(2.0 * unknowns);
}

std::string OutlierPull::Describe() const {
  return fmt::format(
      "{} of {} residuals are of outliers, which pull at the answer under this loss more than "
      "chance explains; the sigmas hold the shift, and loss=tukey, which gives outliers no weight, "
      "avoids it",
      all_ - near_, all_);
}

}  // namespace sextant
