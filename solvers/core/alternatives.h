// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// A pose explains the pairs about as well as the best one where the likelihood of the best is at
/// most this many times its own. With unknown noise and f redundant residuals the ratio is that of
/// the sums of squares to the power f / 2 (the likelihood with the noise integrated out), so that
/// for four pixels (f = 2) ten times the RMSE, and for twenty (f = 34) 1.15 times, are the limit.
/// With stated noise it is exp(half of the difference of the sums), where the sums are divided by
/// the residual variance if that exceeds the stated one.
inline constexpr double kMaxLikelihoodRatio = 100.0;

/// The poses that explain the pairs of an answer about as well as each other, best first.
struct LikelyPoses {
  std::vector<Rigid3d> poses;
  /// The place among them of the minimum that the answer belongs to; none where it explains the
  /// pairs far worse than the first.
  std::optional<std::size_t> of_answer;
};

/// The minima of the squared residuals of the pixels that `answer` is based on: the one that it
/// belongs to, and those of its alternatives, of its mirror image for points near a plane, and of
/// the P3P poses for up to five points. A listed pose projects every one of these points, differs
/// from the others by more than 1e-3 rad, and is likely by kMaxLikelihoodRatio.
///
/// A pose of a plane and its reflection in the plane across the line of sight have the same image
/// to first order (Schweighofer and Pinz 2006, "Robust pose estimation from a planar target", PAMI
/// 28). Empty, without a further test, where nothing of the above applies: for 3D-3D pairs, and
/// solvers that keep a part of a given start. Cost: for points off a plane one pass over
/// them, else a least-squares fit for each candidate.
LikelyPoses FindLikelyPoses(const CalibrationProblem& problem, const SolverSpec& spec,
                            const Estimate& answer);

}  // namespace sextant
