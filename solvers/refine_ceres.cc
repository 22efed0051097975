// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine_ceres.h"

#include <ceres/ceres.h>

#include <cmath>
#include <memory>

#include "solvers/barron_loss.h"
#include "solvers/rotation_manifold.h"
#include "solvers/term_derivatives.h"

namespace sextant {
namespace {

using RowMajor34 = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;

// The residual of one pair and its derivatives by (dphi, dt), lifted to the quaternion: Ceres
// multiplies by PlusJacobian, whose left inverse is MinusJacobian.
template <class Term, int kResiduals>
class PairCost final : public ceres::SizedCostFunction<kResiduals, 4, 3> {
 public:
  PairCost(const Term& term, const Camera* camera) : term_(term), camera_(camera) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[1]);
    TermDerivatives<kResiduals> at;
    if (!Differentiate(term_, camera_, rotation.toRotationMatrix(), translation, at)) return false;
    // Ceres prints numbers that are not finite, but not refusals.
    const Eigen::Matrix<double, kResiduals, 6> jacobian = at.Jacobian();
    if (!at.residual.allFinite() || !jacobian.allFinite()) return false;
    Eigen::Map<Eigen::Matrix<double, kResiduals, 1>> residual(residuals);
    residual = at.residual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) {
      RowMajor34 lift;
      RotationManifold().MinusJacobian(parameters[0], lift.data());
      Eigen::Map<Eigen::Matrix<double, kResiduals, 4, Eigen::RowMajor>> by_rotation(jacobians[0]);
      by_rotation = jacobian.template leftCols<3>() * lift;
    }
    if (jacobians[1] != nullptr) {
      Eigen::Map<Eigen::Matrix<double, kResiduals, 3, Eigen::RowMajor>> by_shift(jacobians[1]);
      by_shift = jacobian.template rightCols<3>();
    }
    return true;
  }

 private:
  Term term_;
  const Camera* camera_;
};

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

// The problem of one pose; `pose` and `terms` must live as long.
class PoseProblem {
 public:
  PoseProblem(const TermsView& terms, Rigid3d& pose, const RobustLoss& loss)
      : rotation_(pose.rotation.coeffs().data()), translation_(pose.translation.data()) {
    problem_.AddParameterBlock(rotation_, 4, new RotationManifold);
    problem_.AddParameterBlock(translation_, 3);
    for (const PointTerm& term : terms.points) {
      problem_.AddResidualBlock(new PairCost<PointTerm, 3>(term, nullptr), NewLoss(loss), rotation_,
                                translation_);
    }
    for (const PixelTerm& term : terms.pixels) {
      problem_.AddResidualBlock(new PairCost<PixelTerm, 2>(term, terms.camera), NewLoss(loss),
                                rotation_, translation_);
    }
  }

  ceres::Problem& problem() { return problem_; }
  const double* rotation() const { return rotation_; }
  const double* translation() const { return translation_; }

 private:
  ceres::Problem problem_;
  double* rotation_;
  double* translation_;
};

ceres::Solver::Options OptionsFor(const RefineLimits& limits) {
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

template <int kResiduals, class Term>
bool AddWeighted(std::span<const Term> terms, const Camera* camera, const ceres::LossFunction* loss,
                 RefinedPose& sum) {
  const Eigen::Matrix3d r = sum.cam_from_lidar.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const Term& term : terms) {
    if (!Differentiate(term, camera, r, sum.cam_from_lidar.translation, at)) return false;
    const double squared = at.residual.squaredNorm();
    double rho[3] = {squared, 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(squared, rho);
    const Eigen::Matrix<double, kResiduals, 6> jacobian = at.Jacobian();
    sum.information += rho[1] * jacobian.transpose() * jacobian;
    sum.cost += 0.5 * rho[0];
  }
  return true;
}

// Cost and information at the pose in `sum`; false where they are not numbers.
bool SumUp(const TermsView& terms, const RobustLoss& loss, RefinedPose& sum) {
  const std::unique_ptr<ceres::LossFunction> weigh(NewLoss(loss));
  sum.cost = 0.0;
  sum.information.setZero();
  return AddWeighted<3>(terms.points, nullptr, weigh.get(), sum) &&
         AddWeighted<2>(terms.pixels, terms.camera, weigh.get(), sum) && std::isfinite(sum.cost);
}

}  // namespace

RefinedPose RefinePoseWithCeres(const TermsView& terms, const Rigid3d& start,
                                const RobustLoss& loss, const RefineLimits& limits) {
  RefinedPose refined;
  refined.cam_from_lidar = start;
  if (!SumUp(terms, loss, refined)) {
    refined.outcome = RefineOutcome::kNotProjected;
    return refined;
  }
  PoseProblem pose_problem(terms, refined.cam_from_lidar, loss);
  ceres::Solver::Summary summary;
  ceres::Solve(OptionsFor(limits), &pose_problem.problem(), &summary);
  refined.iterations = static_cast<int>(summary.iterations.size());
  refined.outcome = OutcomeOf(summary.termination_type);
  SumUp(terms, loss, refined);
  return refined;
}

std::optional<Matrix6d> CeresCovariance(const TermsView& terms, const Rigid3d& pose) {
  Rigid3d at = pose;
  PoseProblem pose_problem(terms, at, {});
  const std::vector<const double*> blocks = {pose_problem.rotation(), pose_problem.translation()};
  ceres::Covariance::Options options;
  options.algorithm_type = ceres::DENSE_SVD;
  ceres::Covariance covariance(options);
  if (!covariance.Compute(blocks, &pose_problem.problem())) return std::nullopt;
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> matrix;
  if (!covariance.GetCovarianceMatrixInTangentSpace(blocks, matrix.data())) return std::nullopt;
  return Matrix6d(matrix);
}

}  // namespace sextant
