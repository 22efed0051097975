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
  /// Covariance of (dphi [rad], dt [m]). If the residuals exceed the stated covariances of the
  /// pixels (inaccurate lens model or board), it is scaled up by that factor.
  Matrix6d covariance = Matrix6d::Zero();
  double rms_px = 0.0;      ///< RMS of the distances between pixels and projections.
  double chi_square = 0.0;  ///< Sum of squared whitened residuals.
  int residuals = 0;        ///< Number of residuals in chi_square.
  /// The other tilt of the board, if it fits nearly as well, as for a small or distant board seen
  /// frontally. The first pose is then only the likelier one; other views or sensors must decide.
  std::optional<Rigid3d> ambiguous_with{};
  double ambiguity_chi_square = 0.0;  ///< Excess chi-square of the other pose; 0 if there is none.
};

/// Estimates the pose from all points by least squares of whitened reprojection errors.
///
/// Each group alone gives two initial poses by IPPE (solvers/pnp/ippe.h; Collins and Bartoli 2014);
/// each is refined over all points by Levenberg-Marquardt, and the best minimum is used. Another
/// minimum is kept as `ambiguous_with` unless a likelihood-ratio test at 1 % (chi-square 9.2
/// between the two hypotheses, scaled as the covariance is) rejects it. Errors: kTooFewPairs (no
/// group); kDegenerate, kMirrored from IPPE for every group; kNoConvergence; kInvalidInput for a
/// covariance that is not positive definite or not of the points' size.
Expected<BoardPose> EstimateBoardPose(const Camera& camera, std::span<const BoardPoints> groups);

/// The corners of a board, in the order of Board: 4, or 8 where it has a hole. [m]
std::vector<Eigen::Vector3d> BoardCorners(const Board& board);

/// Points of a board in the camera frame, with their covariance due to the pose.
struct PointsInCam {
  std::vector<Eigen::Vector3d> points{};
  /// 3n x 3n [m^2]: all points share the error of the pose, so they are strongly correlated.
  Eigen::MatrixXd covariance{};
  Eigen::Matrix3d CovarianceOf(std::size_t i) const {
    const auto at = 3 * static_cast<Eigen::Index>(i);
    return covariance.block<3, 3>(at, at);
  }
};
PointsInCam ToCamera(const BoardPose& pose, std::span<const Eigen::Vector3d> points_in_board);

}  // namespace sextant
