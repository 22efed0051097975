// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The formula for averaging rotations; see rotation_average.h.
enum class RotationAverage { kChordal, kQuaternionSum, kOriginalRunning };

/// Mean of the translations (as in the original package) and average of the rotations, in the given
/// order. Errors: kMissingData (no poses), kDegenerate (rotations without a mean).
Expected<Rigid3d> AveragePoses(std::span<const Rigid3d> poses, RotationAverage kind);

/// The answer of one view, followed by its alternatives.
using PoseCandidates = std::vector<Rigid3d>;

/// One candidate of each view, so that their rotations agree best: those nearest to the candidate
/// for which the sum of the angles to them is the least. The average of a pose and of the mirror
/// image of another explains neither view. Takes time in the square of the number of candidates
/// where a view has alternatives; else each view's only one.
std::vector<Rigid3d> AgreeingPoses(std::span<const PoseCandidates> views);

/// Covariance of (dphi, dt) of the average of independent answers.
///
/// From 3 poses on it is their scatter about the mean (divisor n - 1) times the sum of squared
/// weights: 1/n, and for the rotation of kOriginalRunning at least 1/3 for any n. Fewer than 7
/// poses do not determine six-dimensional correlations, so that only the variances are given. One
/// or two poses do not determine a scatter: their own covariances are propagated; none where one is
/// missing.
std::optional<Matrix6d> AverageCovariance(std::span<const Rigid3d> poses,
                                          std::span<const std::optional<Matrix6d>> covariances,
                                          const Rigid3d& average, RotationAverage kind);

}  // namespace sextant
