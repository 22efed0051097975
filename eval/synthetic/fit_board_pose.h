// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/joint/board_view_residuals.h"

namespace sextant {

/// The pose of a board estimated from one sensor alone, with its covariance: the best that a
/// two-stage extractor can make of the raw observations.
struct BoardPoseFit {
  Rigid3d sensor_from_board;
  Matrix6d covariance;  ///< Covariance of (dphi [rad], dt [m]): inverse of J^T J at the solution.
};

/// Least squares near `start` by MinimisePose. Errors: kDegenerate (the observations of that
/// sensor leave a direction undetermined), kNoConvergence.
Expected<BoardPoseFit> FitBoardInCamera(const BoardViewTerms& terms, const Camera& camera,
                                        const Rigid3d& start);
Expected<BoardPoseFit> FitBoardInLidar(const BoardViewTerms& terms, const Rigid3d& start);

}  // namespace sextant
