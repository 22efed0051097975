// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"
#include "geometry/calibration_problem.h"
#include "solvers/joint/board_view_residuals.h"

namespace sextant {

using Vector12d = Eigen::Matrix<double, 12, 1>;
using Matrix12d = Eigen::Matrix<double, 12, 12>;

/// Normal equations of the observations of one board by both sensors, linearised at two poses.
struct BoardViewInformation {
  /// J^T J of the whitened residuals by (dphi, dt) of cam_from_lidar, then (dphi, dt) of
  /// cam_from_board; both poses are perturbed as by Perturb.
  Matrix12d normal = Matrix12d::Zero();
  Vector12d gradient = Vector12d::Zero();  ///< J^T r.
  double cost = 0.0;                       ///< 1/2 |r|^2.
};

/// Derivative of the (dphi, dt) of lidar_from_board by the twelve of BoardViewInformation.
Eigen::Matrix<double, 6, 12> RelativePoseByPoses(const Rigid3d& cam_from_lidar,
                                                 const Rigid3d& cam_from_board);

/// The observations of the view may also be predicted ones of a hypothetical board pose. Requires a
/// view that passes CheckBoardView. Errors: kInvalidInput where a printed point does not project,
/// or a ray does not meet the board's plane, at these poses.
Expected<BoardViewInformation> InformationOfPoses(const BoardView& view, const Board& board,
                                                  const Camera& camera,
                                                  const Rigid3d& cam_from_lidar,
                                                  const Rigid3d& cam_from_board);

/// Pseudo-inverse of a positive semidefinite matrix over (rad, m): directions that are singular
/// after scaling to a unit diagonal get zero.
Matrix6d PseudoInverse(const Matrix6d& information);

/// H_xx - H_xb H_bb^+ H_bx: the Fisher information of a view on cam_from_lidar [rad, m], the pose
/// of its board unknown. Views are independent, so that their informations add up. Singular, which
/// is no error, where one of the sensors does not determine a direction of the board.
Matrix6d EliminateBoard(const Matrix12d& normal);

/// Both steps. Errors: those of InformationOfPoses.
Expected<Matrix6d> InformationOfView(const BoardView& view, const Board& board,
                                     const Camera& camera, const Rigid3d& cam_from_lidar,
                                     const Rigid3d& cam_from_board);

}  // namespace sextant
