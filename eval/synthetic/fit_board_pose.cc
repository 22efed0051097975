// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/fit_board_pose.h"

#include <optional>

#include "geometry/symmetric.h"
#include "solvers/least_squares/minimise_pose.h"

namespace sextant {
namespace {

struct Equations {
  Matrix6d information = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
  double squares = 0.0;
};

bool SumInCamera(const BoardViewTerms& terms, const Camera& camera, const Rigid3d& pose,
                 Equations& sum) {
  sum = {};
  PrintedResidual at;
  for (const PrintedTerm& term : terms.printed) {
    if (!Differentiate(term, camera, pose, at)) return false;
    sum.information += at.by_pose.transpose() * at.by_pose;
    sum.gradient += at.by_pose.transpose() * at.value;
    sum.squares += at.value.squaredNorm();
  }
  return true;
}

bool SumInLidar(const BoardViewTerms& terms, const Rigid3d& pose, Equations& sum) {
  sum = {};
  RayResidual at;
  const BoardPlane plane(pose);
  const auto add = [&](const auto& rays) {
    for (const auto& term : rays) {
      if (!Differentiate(term, plane, at)) return false;
      sum.information += at.by_pose.transpose() * at.by_pose;
      sum.gradient += at.by_pose.transpose() * at.value;
      sum.squares += at.value * at.value;
    }
    return true;
  };
  return add(terms.face) && add(terms.edges);
}

template <class Evaluate>
Expected<BoardPoseFit> Fit(const Evaluate& evaluate, const Rigid3d& start) {
  const PoseMinimum<Equations> best =
      MinimisePose<Equations>(evaluate, start, {.max_iterations = 100});
  if (best.outcome != RefineOutcome::kNotProjected) {
    const std::optional<Matrix6d> covariance = InvertSymmetric(best.equations.information);
    if (!covariance) {
      return MakeError(
          ErrorCode::kDegenerate,
          "the observations of one sensor do not determine one direction of the board's pose");
    }
    if (best.outcome == RefineOutcome::kConverged) return BoardPoseFit{best.pose, *covariance};
  }
  return MakeError(ErrorCode::kNoConvergence, "the fit of the board's pose did not converge");
}

}  // namespace

Expected<BoardPoseFit> FitBoardInCamera(const BoardViewTerms& terms, const Camera& camera,
                                        const Rigid3d& start) {
  return Fit(
      [&](const Rigid3d& pose, Equations& sum) { return SumInCamera(terms, camera, pose, sum); },
      start);
}

Expected<BoardPoseFit> FitBoardInLidar(const BoardViewTerms& terms, const Rigid3d& start) {
  return Fit([&](const Rigid3d& pose, Equations& sum) { return SumInLidar(terms, pose, sum); },
             start);
}

}  // namespace sextant
