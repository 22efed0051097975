// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// The Cramer-Rao bound: no unbiased estimator has a smaller covariance of (dphi [rad], dt [m]).
///
/// Inverse of the Fisher information sum_i J_i^T Sigma_i^-1 J_i of all pairs of the problem, with
/// the residuals linearised at the true pose and the noise that the pairs state (van Trees 1968).
/// Errors: kMissingData (no pairs, or pairs that state no noise), kDegenerate (singular
/// information), kInvalidInput (2D-3D pairs without a camera, or a point that does not project).
Expected<Matrix6d> CramerRaoBound(const CalibrationProblem& problem,
                                  const Rigid3d& true_cam_from_lidar);

/// The bound of the raw observations of boards, whose poses are unknown too: inverse of the sum
/// over `problem.board_views` of InformationOfView at the truth
/// (solvers/joint/board_view_information.h). true_cam_from_board: of each view, in their order.
/// Errors: kMissingData (no views), kInvalidInput (no camera, a view that CheckBoardView refuses or
/// that is not seen at the truth), kNonFinite, kDegenerate (singular information).
Expected<Matrix6d> CramerRaoBoundOfViews(const CalibrationProblem& problem,
                                         const Rigid3d& true_cam_from_lidar,
                                         std::span<const Rigid3d> true_cam_from_board);

/// The root mean square errors that go with a covariance.
struct RmsError {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
};
RmsError RmsOf(const Matrix6d& covariance);

}  // namespace sextant
