// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "base/error.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// The Cramer-Rao bound: a lower bound of the covariance of (dphi [rad], dt [m]) for every unbiased
/// estimator.
///
/// It is the inverse of the Fisher information sum_i J_i^T Sigma_i^-1 J_i of all pairs of the
/// problem, with the residuals linearised at the true pose and the noise stated in the pairs (van
/// Trees 1968). Errors: kMissingData (no pairs, or pairs that state no noise), kDegenerate
/// (singular information), kInvalidInput (2D-3D pairs without a camera, or a point that does not
/// project).
Expected<Matrix6d> CramerRaoBound(const CalibrationProblem& problem,
                                  const Rigid3d& true_cam_from_lidar);

/// The bound for raw observations of boards whose poses are unknown as well: the inverse of the sum
/// of InformationOfView (solvers/joint/board_view_information.h) over `problem.board_views` at the
/// true poses. true_cam_from_board: one pose per view, in the same order. Errors: kMissingData (no
/// views), kInvalidInput (no camera, a view that CheckBoardView refuses or that is not seen at the
/// truth), kNonFinite, kDegenerate (singular information).
Expected<Matrix6d> CramerRaoBoundOfViews(const CalibrationProblem& problem,
                                         const Rigid3d& true_cam_from_lidar,
                                         std::span<const Rigid3d> true_cam_from_board);

/// The same where the LiDAR has systematic errors (`problem.lidar_errors`), which are further
/// unknowns with normal priors, as for the solver joint: the Bayesian bound (van Trees 1968). The
/// white noise is that stated by the views. Errors: as above.
Expected<Matrix6d> CramerRaoBoundOfSession(const CalibrationProblem& problem,
                                           const Rigid3d& true_cam_from_lidar,
                                           std::span<const Rigid3d> true_cam_from_board);

/// The root mean square errors that a covariance implies.
struct RmsError {
  double rotation_rad = 0.0;
  double translation_m = 0.0;
};
RmsError RmsOf(const Matrix6d& covariance);

}  // namespace sextant
