// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

struct BoardPose {
  Rigid3d cam_from_board{};
  /// Of (dphi [rad], dt [m]). Where the pixels fit worse than their covariances say (a lens model
  /// or board that is not quite right), it is larger by that factor.
  Matrix6d covariance = Matrix6d::Zero();
  double rms_px = 0.0;      ///< Of the distances between pixels and projections.
  double chi_square = 0.0;  ///< Sum of squared whitened residuals...
  int residuals = 0;        ///< ...of so many numbers.
  /// The other way the board may lean, where it fits nearly as well: a small or distant board seen
  /// squarely. The first pose is the likelier one then, and no more. Other views or sensors decide.
  std::optional<Rigid3d> ambiguous_with{};
  double ambiguity_chi_square = 0.0;  ///< By how much the other way fits worse; 0 where none is.
};

/// The pose that fits all points at once: least squares of whitened reprojection errors.
///
/// Each group alone gives two starts by IPPE (solvers/pnp/ippe.h; Collins and Bartoli 2014), each
/// is refined over all points by Levenberg-Marquardt, and the best minimum is taken. Another
/// minimum stays as `ambiguous_with` where a likelihood-ratio test at 1 % (chi-square 9.2 of two
/// hypotheses, scaled as the covariance is) does not refuse it.
/// Errors: kTooFewPairs (no group); kDegenerate, kMirrored from IPPE for every group;
/// kNoConvergence; kInvalidInput for a covariance that is not positive definite or not of the
/// points' size.
Expected<BoardPose> EstimateBoardPose(const Camera& camera, std::span<const BoardPoints> groups);

/// The corners of a board, in the order of Board: 4, or 8 where it has a hole. [m]
std::vector<Eigen::Vector3d> BoardCorners(const Board& board);

/// Points of a board in the camera frame, with the covariance that the pose gives them.
struct PointsInCam {
  std::vector<Eigen::Vector3d> points{};
  /// 3n x 3n [m^2]: all share the pose's error, so they are far from independent.
  Eigen::MatrixXd covariance{};
  Eigen::Matrix3d CovarianceOf(std::size_t i) const {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    return covariance.block<3, 3>(at, at);
  }
};
PointsInCam ToCamera(const BoardPose& pose, std::span<const Eigen::Vector3d> points_in_board);

}  // namespace sextant
