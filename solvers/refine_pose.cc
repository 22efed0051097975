// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine_pose.h"

#include <algorithm>
#include <cmath>

#include "solvers/invert_information.h"
#include "solvers/term_derivatives.h"

namespace sextant {
namespace {

constexpr double kFirstDamping = 1e-6;
constexpr double kLargestDamping = 1e12;
// The cost is a sum of many rounded terms: a rise of this share is no rise.
constexpr double kCostRounding = 1e-14;

struct NormalEquations {
  Matrix6d information;  // J^T J
  Vector6d gradient;     // J^T r
  double squares = 0.0;
};

// The blocks of the normal equations. With M = A^T A and v = -A^T r of a term, J^T J is
// [[arm]x M [arm]x^T, [arm]x M; ., M] and J^T r is [arm x v; v]: half the work of J^T J itself.
struct Blocks {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d turn_shift = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d shift = Eigen::Matrix3d::Zero();
  Eigen::Vector3d turn_gradient = Eigen::Vector3d::Zero();
  Eigen::Vector3d shift_gradient = Eigen::Vector3d::Zero();
  double squares = 0.0;

  template <int kResiduals>
  void Add(const TermDerivatives<kResiduals>& at) {
    const Eigen::Matrix3d m = at.slope.transpose() * at.slope;
    const Eigen::Vector3d v = -(at.slope.transpose() * at.residual);
    Eigen::Matrix3d arm_m;
    for (int k = 0; k < 3; ++k) arm_m.col(k) = at.arm.cross(m.col(k));
    for (int k = 0; k < 3; ++k) {
      turn.col(k) += at.arm.cross(Eigen::Vector3d(arm_m.row(k)));
    }
    turn_shift += arm_m;
    shift += m;
    turn_gradient += at.arm.cross(v);
    shift_gradient += v;
    squares += at.residual.squaredNorm();
  }
};

template <int kResiduals, class Term>
bool AddTerms(std::span<const Term> terms, const Camera* camera, const Rigid3d& pose, Blocks& sum) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const Term& term : terms) {
    if (!Differentiate(term, camera, r, pose.translation, at)) return false;
    sum.Add(at);
  }
  return true;
}

// False where a point does not project or the numbers overflow.
bool SumUp(const TermsView& terms, const Rigid3d& pose, NormalEquations& sum) {
  Blocks blocks;
  if (!AddTerms<3>(terms.points, nullptr, pose, blocks)) return false;
  if (!AddTerms<2>(terms.pixels, terms.camera, pose, blocks)) return false;
  sum.information << blocks.turn, blocks.turn_shift, blocks.turn_shift.transpose(), blocks.shift;
  sum.gradient << blocks.turn_gradient, blocks.shift_gradient;
  sum.squares = blocks.squares;
  return std::isfinite(sum.squares);
}

// The step of the damped equations by L D L^T, unrolled: Eigen's takes three times as long. None
// where a pivot is not positive.
std::optional<Vector6d> DampedStep(const NormalEquations& equations, double damping) {
  Matrix6d l = equations.information;
  Matrix6d ld;  // l(i, k) d(k)
  Vector6d inverse_d;
  Vector6d x = -equations.gradient;
  for (int j = 0; j < 6; ++j) {
    double d = (1.0 + damping) * l(j, j);
    for (int k = 0; k < j; ++k) d -= l(j, k) * ld(j, k);
    if (!(d > 0.0)) return std::nullopt;
    inverse_d[j] = 1.0 / d;
    for (int i = j + 1; i < 6; ++i) {
      double sum = l(i, j);
      for (int k = 0; k < j; ++k) sum -= l(i, k) * ld(j, k);
      ld(i, j) = sum;
      l(i, j) = sum * inverse_d[j];
    }
    for (int i = j + 1; i < 6; ++i) x[i] -= l(i, j) * x[j];
  }
  x.array() *= inverse_d.array();
  for (int j = 5; j > 0; --j) {
    for (int i = 0; i < j; ++i) x[i] -= l(j, i) * x[j];
  }
  return x;
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
  Rigid3d next;
  double damping = kFirstDamping;
  best.iterations = 1;
  while (best.iterations < limits.max_iterations) {
    const std::optional<Vector6d> step = DampedStep(here, damping);
    if (step && IsNegligible(*step, best.cam_from_lidar, limits.step_tolerance)) {
      best.outcome = RefineOutcome::kConverged;
      break;
    }
    ++best.iterations;
    bool falls = false;
    if (step && step->allFinite()) {
      next = Perturb(best.cam_from_lidar, *step);
      falls = SumUp(terms, next, there) && there.squares <= (1.0 + kCostRounding) * here.squares;
    }
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
  return InvertSymmetric(information);
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
