// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/joint/board_view_residuals.h"

namespace sextant {

/// The pose of a board as one sensor alone tells it, and how sure: what a two-stage extractor makes
/// of the raw observations at best.
struct BoardPoseFit {
  Rigid3d sensor_from_board;
  Matrix6d covariance;  ///< Of (dphi, dt); the inverse of J^T J at the answer.
};

/// Least squares near `start` by Levenberg and Marquardt. Errors: kDegenerate (the observations of
/// that sensor leave a direction open), kNoConvergence.
Expected<BoardPoseFit> FitBoardInCamera(const BoardViewTerms& terms, const Camera& camera,
                                        const Rigid3d& start);
Expected<BoardPoseFit> FitBoardInLidar(const BoardViewTerms& terms, const Rigid3d& start);

}  // namespace sextant
