// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The residuals of the raw observations of a board, for the joint solver, the bound and
/// evaluation: measured minus predicted, whitened, so that each has a variance of 1. Those of the
/// camera depend on cam_from_board alone, those of the LiDAR on lidar_from_board alone.

/// A straight side in the board's plane: outward.dot(point) = offset_m on it.
struct BoardSide {
  Eigen::Vector2d outward = Eigen::Vector2d::UnitX();  ///< Unit, away from the material.
  double offset_m = 0.0;
  /// Derivative of the offset by (top_right_m, right_bottom_m): 1/2 for the outer sides, 0 for
  /// those of the opening.
  Eigen::Vector2d offset_by_size = Eigen::Vector2d::Zero();
};

/// As numbered in EdgeRay::side. Requires a side that the board has; `side` below kFirstRim.
BoardSide SideOf(const Board& board, int side);

/// The tangent of a round hole's rim nearest to a point in the board. It replaces the rim for edge
/// rays there: a tangent shift of d moves the rim by d^2 / (2 radius), 0.1 mm for 5 mm.
BoardSide TangentOf(const RoundHole& hole, const Eigen::Vector2d& in_board);

struct PrintedTerm {
  std::vector<Eigen::Vector2d> in_board_m;
  std::vector<Eigen::Vector2d> pixels;
  Eigen::MatrixXd whitener;  ///< Lower triangular W with W^T W the inverse covariance.
};

struct FaceTerm {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< Unit.
  double range_m = 0.0;
  double inverse_sigma = 0.0;
};

struct EdgeTerm {
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();  ///< Unit.
  BoardSide side;
  double inverse_sigma = 0.0;
};

/// A BoardView with everything precomputed that does not change with the poses.
struct BoardViewTerms {
  std::vector<PrintedTerm> printed;
  std::vector<FaceTerm> face;
  std::vector<EdgeTerm> edges;
};

/// Requires a view that passes CheckBoardView.
BoardViewTerms TermsOf(const BoardView& view, const Board& board);

/// Residuals of all coordinates of a term, with their derivative by (dphi, dt) of cam_from_board.
struct PrintedResidual {
  Eigen::VectorXd value;  ///< 2n.
  Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;
  std::vector<Eigen::Vector3d> in_cam;  ///< The points in the camera frame.
};

/// False where a point does not project.
bool Differentiate(const PrintedTerm& term, const Camera& camera, const Rigid3d& cam_from_board,
                   PrintedResidual& out);

/// The pose of a board as axes and origin in the LiDAR frame.
struct BoardPlane {
  explicit BoardPlane(const Rigid3d& lidar_from_board)
      : axes(lidar_from_board.rotation.toRotationMatrix()), origin(lidar_from_board.translation) {}

  Eigen::Matrix3d axes;  ///< Columns x, y and the normal.
  Eigen::Vector3d origin;
};

/// Residual of one ray, with its derivative by (dphi, dt) of lidar_from_board.
struct RayResidual {
  double value = 0.0;
  Eigen::Matrix<double, 1, 6> by_pose;
};

/// (range - s) / sigma, s the distance along the ray to the board's plane:
/// s = n.o / n.d, ds = ((m x n).dphi + n.dt) / n.d with m = s d - o in the plane.
/// False where the ray does not intersect the plane in front of the LiDAR.
bool Differentiate(const FaceTerm& term, const BoardPlane& plane, RayResidual& out);

/// (offset - outward.u) / sigma, u the intersection of the ray with the plane: the signed distance
/// inwards from the side. False as above.
bool Differentiate(const EdgeTerm& term, const BoardPlane& plane, RayResidual& out);

/// Residuals without derivatives, for evaluation: per printed point (the norm of the whitened
/// residual of a whole BoardPoints, over the root of its 2n), per face return, per edge ray;
/// infinite where there is none.
struct BoardViewResiduals {
  std::vector<double> printed;
  std::vector<double> face;
  std::vector<double> edges;
};
BoardViewResiduals ResidualsOf(const BoardView& view, const Board& board, const Camera& camera,
                               const Rigid3d& cam_from_lidar, const Rigid3d& cam_from_board);

}  // namespace sextant
