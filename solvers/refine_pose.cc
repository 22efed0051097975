// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine_pose.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "solvers/term_derivatives.h"

namespace sextant {
namespace {

constexpr double kFirstDamping = 1e-6;
constexpr double kLargestDamping = 1e12;
// The cost is a sum of many rounded terms: a rise of this share is no rise.
constexpr double kCostRounding = 1e-14;
// Pivots of the unit-diagonal information below this are rounding.
constexpr double kMinPivot = 1e-13;

struct NormalEquations {
  Matrix6d information = Matrix6d::Zero();  // J^T J
  Vector6d gradient = Vector6d::Zero();     // J^T r
  double squares = 0.0;
};

template <int kResiduals, class Term>
bool AddTerms(std::span<const Term> terms, const Camera* camera, const Rigid3d& pose,
              NormalEquations& sum) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const Term& term : terms) {
    if (!Differentiate(term, camera, r, pose.translation, at)) return false;
    sum.information.noalias() += at.jacobian.transpose() * at.jacobian;
    sum.gradient.noalias() += at.jacobian.transpose() * at.residual;
    sum.squares += at.residual.squaredNorm();
  }
  return true;
}

// False where a point does not project or the numbers overflow.
bool SumUp(const TermsView& terms, const Rigid3d& pose, NormalEquations& sum) {
  sum = NormalEquations();
  return AddTerms<3>(terms.points, nullptr, pose, sum) &&
         AddTerms<2>(terms.pixels, terms.camera, pose, sum) && std::isfinite(sum.squares);
}

Vector6d DampedStep(const NormalEquations& equations, double damping) {
  Matrix6d damped = equations.information;
  damped.diagonal() *= 1.0 + damping;
  return -damped.ldlt().solve(equations.gradient);
}

bool IsNegligible(const Vector6d& step, const Rigid3d& pose, double tolerance) {
  return step.head<3>().norm() <= tolerance &&
         step.tail<3>().norm() <= tolerance * (1.0 + pose.translation.norm());
}

}  // namespace

RefinedPose RefinePose(const TermsView& terms, const Rigid3d& start, const RefineLimits& limits) {
  RefinedPose best;
  best.cam_from_lidar = start;
  NormalEquations here;
  if (!SumUp(terms, start, here)) {
    best.outcome = RefineOutcome::kNotProjected;
    return best;
  }
  NormalEquations there;
  double damping = kFirstDamping;
  best.iterations = 1;
  while (best.iterations < limits.max_iterations) {
    const Vector6d step = DampedStep(here, damping);
    if (IsNegligible(step, best.cam_from_lidar, limits.step_tolerance)) {
      best.outcome = RefineOutcome::kConverged;
      break;
    }
    const Rigid3d next = Perturb(best.cam_from_lidar, step);
    ++best.iterations;
    const bool falls = step.allFinite() && SumUp(terms, next, there) &&
                       there.squares <= (1.0 + kCostRounding) * here.squares;
    if (falls) {
      best.cam_from_lidar = next;
      here = there;
      damping *= 0.1;
    } else {
      damping = std::max(10.0 * damping, kFirstDamping);
      if (damping > kLargestDamping) {
        best.outcome = RefineOutcome::kStalled;
        break;
      }
    }
  }
  best.cost = 0.5 * here.squares;
  best.information = here.information;
  return best;
}

std::optional<Matrix6d> InvertInformation(const Matrix6d& information) {
  const Vector6d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  const Matrix6d unit = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Matrix6d> factor(unit);
  if (factor.info() != Eigen::Success || !(factor.vectorD().minCoeff() > kMinPivot)) {
    return std::nullopt;
  }
  const Matrix6d inverse =
      scale.asDiagonal() * factor.solve(Matrix6d::Identity()).eval() * scale.asDiagonal();
  return Matrix6d(0.5 * (inverse + inverse.transpose()));
}

std::optional<Matrix6d> LeastSquaresCovariance(const PairTerms& terms, const Matrix6d& information,
                                               double cost) {
  std::optional<Matrix6d> covariance = InvertInformation(information);
  if (!covariance || terms.noise_known) return covariance;
  const double freedom = 3.0 * static_cast<double>(terms.points.size()) +
                         2.0 * static_cast<double>(terms.pixels.size()) - 6.0;
  if (freedom <= 0.0) return std::nullopt;
  return Matrix6d(*covariance * (2.0 * cost / freedom));
}

}  // namespace sextant
