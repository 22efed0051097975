// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/fit_board_pose.h"

#include <cmath>
#include <optional>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

struct Normal {
  Matrix6d matrix = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double cost = 0.0;
};

std::optional<Normal> NormalInCamera(const BoardViewTerms& terms, const Camera& camera,
                                     const Rigid3d& pose) {
  Normal normal;
  PrintedResidual at;
  for (const PrintedTerm& term : terms.printed) {
    if (!Differentiate(term, camera, pose, at)) return std::nullopt;
    normal.matrix += at.by_pose.transpose() * at.by_pose;
    normal.gradient += at.by_pose.transpose() * at.value;
    normal.cost += 0.5 * at.value.squaredNorm();
  }
  return normal;
}

std::optional<Normal> NormalInLidar(const BoardViewTerms& terms, const Rigid3d& pose) {
  Normal normal;
  RayResidual at;
  const BoardPlane plane(pose);
  const auto add = [&](const auto& rays) {
    for (const auto& term : rays) {
      if (!Differentiate(term, plane, at)) return false;
      normal.matrix += at.by_pose.transpose() * at.by_pose;
      normal.gradient += at.by_pose.transpose() * at.value;
      normal.cost += 0.5 * at.value * at.value;
    }
    return true;
  };
  if (!add(terms.face) || !add(terms.edges)) return std::nullopt;
  return normal;
}

template <class NormalAt>
Expected<BoardPoseFit> Fit(const NormalAt& normal_at, const Rigid3d& start) {
  constexpr int kMaxIterations = 100;
  constexpr double kSmallestStep = 1e-10;
  std::optional<Normal> now = normal_at(start);
  Rigid3d pose = start;
  double damping = 1e-6;
  for (int i = 0; now && i < kMaxIterations; ++i) {
    Matrix6d damped = now->matrix;
    damped.diagonal() *= 1.0 + damping;
    const Vector6d step = -SolveSymmetric(damped, now->gradient);
    if (!step.allFinite()) break;
    const Rigid3d tried = Perturb(pose, step);
    const std::optional<Normal> then = normal_at(tried);
    const bool better = then && then->cost <= now->cost;
    if (better) {
      pose = tried;
      now = then;
    }
    if (step.norm() < kSmallestStep) {
      const std::optional<Matrix6d> covariance = InvertSymmetric(now->matrix);
      if (!covariance) break;
      return BoardPoseFit{pose, *covariance};
    }
    damping *= better ? 0.1 : 10.0;
  }
  if (now && !InvertSymmetric(now->matrix)) {
    return MakeError(
        ErrorCode::kDegenerate,
        "the observations of one sensor leave a direction of the board's pose undetermined");
  }
  return MakeError(ErrorCode::kNoConvergence, "the fit of the board's pose did not converge");
}

}  // namespace

Expected<BoardPoseFit> FitBoardInCamera(const BoardViewTerms& terms, const Camera& camera,
                                        const Rigid3d& start) {
  return Fit([&](const Rigid3d& pose) { return NormalInCamera(terms, camera, pose); }, start);
}

Expected<BoardPoseFit> FitBoardInLidar(const BoardViewTerms& terms, const Rigid3d& start) {
  return Fit([&](const Rigid3d& pose) { return NormalInLidar(terms, pose); }, start);
}

}  // namespace sextant
