// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "solvers/joint/board_view_residuals.h"

namespace sextant {

/// The pose of a board from the observations of one sensor alone, and its covariance: the best that
/// a two-stage extractor can make of the raw observations.
struct BoardPoseFit {
  Rigid3d sensor_from_board;
  Matrix6d covariance;  ///< (dphi, dt): the inverse of J^T J at the answer.
};

/// Least squares near `start` (MinimisePose). Errors: kDegenerate (the observations of that sensor
/// do not determine a direction), kNoConvergence.
Expected<BoardPoseFit> FitBoardInCamera(const BoardViewTerms& terms, const Camera& camera,
                                        const Rigid3d& start);
Expected<BoardPoseFit> FitBoardInLidar(const BoardViewTerms& terms, const Rigid3d& start);

}  // namespace sextant
