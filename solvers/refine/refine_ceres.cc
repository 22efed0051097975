// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/refine_ceres.h"

#include <ceres/ceres.h>

#include <cmath>
#include <memory>

#include "solvers/refine/ceres_parts.h"
#include "solvers/refine/pair_cost.h"
#include "solvers/refine/rotation_manifold.h"

namespace sextant {
namespace {

// The problem of one pose; `pose` and `terms` must outlive it.
class CeresPoseProblem {
 public:
  CeresPoseProblem(const TermsView& terms, Rigid3d& pose, const RobustLoss& loss)
      : rotation_(pose.rotation.coeffs().data()), translation_(pose.translation.data()) {
    problem_.AddParameterBlock(rotation_, 4, new RotationManifold);
    problem_.AddParameterBlock(translation_, 3);
    for (const PointTerm& term : terms.points) {
      problem_.AddResidualBlock(new PairCost<PointTerm, 3>(term, nullptr), NewLoss(loss), rotation_,
                                translation_);
    }
    for (const PixelTerm term : terms.pixels) {
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

template <int kResiduals, class Terms>
bool AddWeighted(const Terms& terms, const Camera* camera, const ceres::LossFunction* loss,
                 LossVariance& variance, RefinedPose& sum) {
  const Eigen::Matrix3d r = sum.cam_from_lidar.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const auto& term : terms) {
    if (!Differentiate(term, camera, r, sum.cam_from_lidar.translation, at)) return false;
    const double squared = at.residual.squaredNorm();
    double rho[3] = {squared, 1.0, 0.0};
    if (loss != nullptr) loss->Evaluate(squared, rho);
    const Eigen::Matrix<double, kResiduals, 6> jacobian = at.Jacobian();
    sum.information += rho[1] * jacobian.transpose() * jacobian;
    sum.cost += 0.5 * rho[0];
    variance.Add(squared, kResiduals, rho);
  }
  return true;
}

// Appends `first` + i for each term i of enough weight.
template <int kResiduals, class Terms>
void AppendWeighted(const Terms& terms, const TermsView& of, const Rigid3d& pose,
                    const ceres::LossFunction* loss, int first, std::vector<int>& indices) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  int index = first;
  for (const auto& term : terms) {
    double rho[3] = {0.0, 1.0, 0.0};
    const bool has_residual = Differentiate(term, of.camera, r, pose.translation, at);
    if (has_residual && loss != nullptr) loss->Evaluate(at.residual.squaredNorm(), rho);
    if (has_residual && rho[1] >= kMinLossWeight) indices.push_back(index);
    ++index;
  }
}

template <int kResiduals, class Terms>
bool AddPulls(const Terms& terms, const Camera* camera, const Rigid3d& pose,
              const ceres::LossFunction& loss, OutlierPull& pull) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const auto& term : terms) {
    if (!Differentiate(term, camera, r, pose.translation, at)) return false;
    double rho[3];
    loss.Evaluate(at.residual.squaredNorm(), rho);
    pull.Add(at.Jacobian(), at.residual, rho[1]);
  }
  return true;
}

// Cost and information at the pose in `sum`; false where they are not numbers.
bool SumUp(const TermsView& terms, const RobustLoss& loss, RefinedPose& sum) {
  const std::unique_ptr<ceres::LossFunction> rho(NewLoss(loss));
  sum.cost = 0.0;
  sum.information.setZero();
  LossVariance variance;
  if (!AddWeighted<3>(terms.points, nullptr, rho.get(), variance, sum) ||
      !AddWeighted<2>(terms.pixels, terms.camera, rho.get(), variance, sum)) {
    return false;
  }
  constexpr double kUnknowns = 6.0;
  if (rho) sum.information /= variance.Factor(kUnknowns);
  return std::isfinite(sum.cost);
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
  CeresPoseProblem pose_problem(terms, refined.cam_from_lidar, loss);
  ceres::Solver::Summary summary;
  ceres::Solve(CeresOptions(limits), &pose_problem.problem(), &summary);
  refined.iterations = static_cast<int>(summary.iterations.size());
  refined.outcome = OutcomeOf(summary.termination_type);
  SumUp(terms, loss, refined);
  return refined;
}

std::vector<int> WeightedTerms(const TermsView& terms, const Rigid3d& pose,
                               const RobustLoss& loss) {
  const std::unique_ptr<ceres::LossFunction> rho(NewLoss(loss));
  std::vector<int> indices;
  AppendWeighted<3>(terms.points, terms, pose, rho.get(), 0, indices);
  AppendWeighted<2>(terms.pixels, terms, pose, rho.get(), static_cast<int>(terms.points.size()),
                    indices);
  return indices;
}

std::optional<std::string> AddOutlierPull(const TermsView& terms, const Rigid3d& pose,
                                          const RobustLoss& loss, Matrix6d& covariance) {
  const std::unique_ptr<ceres::LossFunction> rho(NewLoss(loss));
  OutlierPull pull(6);
  if (!rho || !AddPulls<3>(terms.points, nullptr, pose, *rho, pull) ||
      !AddPulls<2>(terms.pixels, terms.camera, pose, *rho, pull)) {
    return std::nullopt;
  }
  if (!pull.Widen(covariance)) return std::nullopt;
  return pull.Describe();
}

std::optional<Matrix6d> CeresCovariance(const TermsView& terms, const Rigid3d& pose) {
  Rigid3d at = pose;
  CeresPoseProblem pose_problem(terms, at, {});
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
