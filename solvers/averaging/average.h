// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// How the rotations of several answers become one; see rotation_average.h.
enum class RotationAverage { kChordal, kQuaternionSum, kOriginalRunning };

/// Mean of the translations (of the original package too) with the average of the rotations, in the
/// order given. Errors: kMissingData (no poses), kDegenerate (rotations without a mean).
Expected<Rigid3d> AveragePoses(std::span<const Rigid3d> poses, RotationAverage kind);

/// Covariance of (dphi, dt) of the average of independent answers.
///
/// From 3 poses on it is their scatter about the mean (n - 1 in the divisor) times the squared
/// weights: 1/n, and for the rotation of kOriginalRunning up to 1/3 however many there are. Fewer
/// than 7 poses cannot show six-dimensional correlations, so only the variances are given. One or
/// two poses show no scatter: their own covariances are propagated, none where one has none.
std::optional<Matrix6d> AverageCovariance(std::span<const Rigid3d> poses,
                                          std::span<const std::optional<Matrix6d>> covariances,
                                          const Rigid3d& average, RotationAverage kind);

}  // namespace sextant
