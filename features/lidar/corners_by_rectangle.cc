// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>

#include "features/lidar/corner_geometry.h"
#include "geometry/board_check.h"

namespace sextant {

Expected<LidarCorners> CornersByRectangle(const BoardPatch& patch, const Board& board) {
  const RectangleFit& fit = patch.fit;
  const Eigen::Rotation2Dd turn(fit.angle_rad);
  const std::vector<Eigen::Vector2d> in_board = CornersInBoard(board);
  const auto rows = static_cast<Eigen::Index>(3 * in_board.size());
  LidarCorners corners;
  corners.board = patch.board;
  Eigen::MatrixXd by_plane(rows, 3);
  Eigen::MatrixXd by_fit(rows, 3);
  for (std::size_t i = 0; i < in_board.size(); ++i) {
    const Eigen::Vector2d arm = turn * in_board[i];
    const Eigen::Vector2d in_plane = fit.center + arm;
    corners.in_lidar.push_back(patch.plane.At(in_plane));
    const auto row = static_cast<Eigen::Index>(3 * i);
    by_plane.middleRows<3>(row) = MovedByPlane(patch.plane, fit.center, in_plane);
    by_fit.middleRows<3>(row) << patch.plane.x_axis, patch.plane.y_axis,
        patch.plane.y_axis * arm.x() - patch.plane.x_axis * arm.y();
  }
  corners.covariance = by_plane * patch.plane.covariance * by_plane.transpose() +
                       by_fit * fit.covariance * by_fit.transpose();
  corners.checks = ChecksOf(patch, board, corners.in_lidar);
  return corners;
}

}  // namespace sextant
