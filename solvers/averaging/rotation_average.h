// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "base/error.h"

namespace sextant {

/// Three ways to average rotations. All take unit quaternions; q and -q are the same rotation.
/// Errors of all: kMissingData (no rotations), kDegenerate (the data leaves the mean undetermined).

/// The least-squares mean in the chordal distance: argmin_R sum_i |R - R_i|_F^2, which is the
/// eigenvector of the largest eigenvalue of sum_i q_i q_i^T. Does not depend on order or signs.
/// Sources: Markley et al. 2007, "Averaging quaternions"; Hartley et al. 2013, "Rotation
/// averaging". kDegenerate where the two largest eigenvalues are equal: two opposite rotations,
/// or a full circle.
Expected<Eigen::Quaterniond> ChordalMean(std::span<const Eigen::Quaterniond> rotations);

/// The paper's formula: sum_i q_i / |sum_i q_i|, each q_i with the sign that is nearer to the
/// first. Differs from ChordalMean in the third order of the spread. kDegenerate where a
/// rotation is half a turn from the first: its sign is then undetermined.
Expected<Eigen::Quaterniond> QuaternionSumMean(std::span<const Eigen::Quaterniond> rotations);

/// The average that the paper's original package logs, for reproduction only: r_1 = q_1 and
/// r_k = (r_(k-1) + q_k) / |r_(k-1) + q_k|. As the sum is normalised each time, the newest rotation
/// always has weight 1/2, the one before 1/4, and so on: it is not a mean, and its noise does not
/// decrease with n. kDegenerate where a rotation is half a turn from the running one.
Expected<Eigen::Quaterniond> OriginalRunningAverage(std::span<const Eigen::Quaterniond> rotations);

/// The q_k with which OriginalRunningAverage steps from `before` = r_(k-1) to `after` = r_k:
/// 2 (r_k . r_(k-1)) r_k - r_(k-1), the mirror image of `before` in `after`. An error e [rad] in
/// `after` becomes 2 e.
Eigen::Quaterniond RecoverOriginalRotation(const Eigen::Quaterniond& before,
                                           const Eigen::Quaterniond& after);

}  // namespace sextant
