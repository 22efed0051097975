// SPDX-License-Identifier: Apache-2.0
#include "solvers/least_squares/refine_pose.h"

#include <algorithm>
#include <cmath>

#include "solvers/kernels/pixel_sums.h"
#include "solvers/least_squares/normal_step.h"
#include "solvers/least_squares/term_derivatives.h"

namespace sextant {
namespace {

constexpr double kFirstDamping = 1e-6;
constexpr double kLargestDamping = 1e12;
// The cost is a sum of many rounded terms: a rise of this share is no rise.
constexpr double kCostRounding = 1e-14;
// Pivots of the information of unit diagonal below this are rounding.
constexpr double kMinPivot = 1e-13;
// Under this, what a step changes of J^T J does not matter: it may be the last, without a look.
constexpr double kLastStep = 1e-6;

using NormalEquations = PixelSums;

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

template <int kResiduals, class Terms>
bool AddTerms(const Terms& terms, const Camera* camera, const Rigid3d& pose, Blocks& sum) {
  const Eigen::Matrix3d r = pose.rotation.toRotationMatrix();
  TermDerivatives<kResiduals> at;
  for (const auto& term : terms) {
    if (!Differentiate(term, camera, r, pose.translation, at)) return false;
    sum.Add(at);
  }
  return true;
}

// False where a point does not project or the numbers overflow.
bool SumUp(const TermsView& terms, const Rigid3d& pose, NormalEquations& sum) {
  const bool is_pinhole = !terms.pixels.empty() && terms.camera->model == CameraModel::kPinhole;
  if (is_pinhole && !SumPixels(terms.pixels.blocks(), PinholePose(*terms.camera, pose), sum)) {
    return false;
  }
  if (is_pinhole && terms.points.empty()) return std::isfinite(sum.squares);
  Blocks blocks;
  if (!AddTerms<3>(terms.points, nullptr, pose, blocks)) return false;
  if (!is_pinhole && !AddTerms<2>(terms.pixels, terms.camera, pose, blocks)) return false;
  NormalEquations others;
  others.information << blocks.turn, blocks.turn_shift, blocks.turn_shift.transpose(), blocks.shift;
  others.gradient << blocks.turn_gradient, blocks.shift_gradient;
  others.squares = blocks.squares;
  if (is_pinhole) {
    sum.information += others.information;
    sum.gradient += others.gradient;
    sum.squares += others.squares;
  } else {
    sum = others;
  }
  return std::isfinite(sum.squares);
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
  double last_size = 0.0;  // Of the last step, where it was taken.
  best.iterations = 1;
  while (best.iterations < limits.max_iterations) {
    const std::optional<Vector6d> step = DampedStep(here.information, here.gradient, damping);
    const double size = step ? SizeOf(*step, best.cam_from_lidar) : 0.0;
    // Steps shrink at least as fast as the last two did: the one after this is negligible.
    const bool is_last = size < kLastStep && size * size <= limits.step_tolerance * last_size;
    if (step && (is_last || size <= limits.step_tolerance)) {
      if (is_last) {
        best.cam_from_lidar = Moved(best.cam_from_lidar, *step);
        here.squares += here.gradient.dot(*step);
        if (limits.wants_information && SumUp(terms, best.cam_from_lidar, there)) {
          here.information = there.information;
        }
      }
      best.outcome = RefineOutcome::kConverged;
      break;
    }
    ++best.iterations;
    bool falls = false;
    if (step && step->allFinite()) {
      next = Moved(best.cam_from_lidar, *step);
      falls = SumUp(terms, next, there) && there.squares <= (1.0 + kCostRounding) * here.squares;
    }
    if (falls) {
      best.cam_from_lidar = next;
      std::swap(here, there);
      damping *= 0.1;
      last_size = size;
    } else {
      damping = std::max(10.0 * damping, kFirstDamping);
      last_size = 0.0;
      if (damping > kLargestDamping) {
        best.outcome = RefineOutcome::kStalled;
        break;
      }
    }
  }
  best.cost = 0.5 * std::max(0.0, here.squares);
  best.information = here.information;
  return best;
}

// By L D L^T of the matrix of unit diagonal, unrolled: Eigen's takes four times as long.
std::optional<Matrix6d> InvertInformation(const Matrix6d& information) {
  const Vector6d scale = information.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return std::nullopt;
  Matrix6d l = scale.asDiagonal() * information * scale.asDiagonal();
  Matrix6d ld;  // l(i, k) d(k)
  Vector6d inverse_d;
  for (int j = 0; j < 6; ++j) {
    double d[6];
    for (int i = j; i < 6; ++i) {
      d[i] = l(i, j);
      for (int k = 0; k < j; ++k) d[i] -= l(i, k) * ld(j, k);
    }
    if (!(d[j] > kMinPivot)) return std::nullopt;
    inverse_d[j] = 1.0 / d[j];
    for (int i = j + 1; i < 6; ++i) {
      ld(i, j) = d[i];
      l(i, j) = d[i] * inverse_d[j];
    }
  }
  Matrix6d lower = Matrix6d::Identity();  // L^-1
  for (int j = 0; j < 6; ++j) {
    for (int i = j + 1; i < 6; ++i) {
      double sum = l(i, j);
      for (int k = j + 1; k < i; ++k) sum += l(i, k) * lower(k, j);
      lower(i, j) = -sum;
    }
  }
  Matrix6d inverse;
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      double sum = 0.0;
      for (int k = i; k < 6; ++k) sum += lower(k, i) * lower(k, j) * inverse_d[k];
      inverse(i, j) = inverse(j, i) = sum * scale[i] * scale[j];
    }
  }
  return inverse;
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
