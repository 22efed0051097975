// SPDX-License-Identifier: Apache-2.0
#include "solvers/least_squares/refine_pose.h"

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/kernels/pixel_sums.h"
#include "solvers/least_squares/term_derivatives.h"

namespace sextant {
namespace {

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
  const auto evaluate = [&terms](const Rigid3d& pose, NormalEquations& sum) {
    return SumUp(terms, pose, sum);
  };
  const PoseMinimum<NormalEquations> best = MinimisePose<NormalEquations>(evaluate, start, limits);
  RefinedPose refined{
      .cam_from_lidar = best.pose, .iterations = best.iterations, .outcome = best.outcome};
  if (best.outcome == RefineOutcome::kNotProjected) return refined;
  refined.cost = 0.5 * std::max(0.0, best.equations.squares);
  refined.information = best.equations.information;
  return refined;
}

std::optional<Matrix6d> LeastSquaresCovariance(const PairTerms& terms, const Matrix6d& information,
                                               double cost) {
  std::optional<Matrix6d> covariance = InvertSymmetric(information);
  if (!covariance || terms.noise_known) return covariance;
  const double freedom = 3.0 * static_cast<double>(terms.points.size()) +
                         2.0 * static_cast<double>(terms.pixels.size()) - 6.0;
  if (freedom <= 0.0) return std::nullopt;
  return Matrix6d(*covariance * (2.0 * cost / freedom));
}

}  // namespace sextant
