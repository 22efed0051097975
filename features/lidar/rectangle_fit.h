// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "features/lidar/edge_points.h"
#include "geometry/board.h"

namespace sextant {

/// A board of known size placed in its plane: in_plane = center + R(angle) * in_board.
struct RectangleFit {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();      ///< [m].
  double angle_rad = 0.0;                                ///< Of the board's x axis.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< Of (center, angle).
  /// For each edge point the side that it lies on: 0 between the corners 0 and 1, clockwise, 4 to 7
  /// of the opening; -1 where it lies on none.
  std::vector<int> sides;
  std::vector<double> sigmas_m;          ///< Of each edge point, across the side it is nearest to.
  std::vector<Eigen::Vector2d> on_edge;  ///< Each without what the beam adds to the board [m].
  double rms = 0.0;                      ///< Of the residuals of those on a side, in sigmas.
  double rms_m = 0.0;                    ///< The same, across the edge.
  double share = 0.0;                    ///< Of the edge points that lie on a side.
  int sides_seen = 0;                    ///< Of the outer four, those with edge points on them.
  /// Size of the outline by that of the board. Farther from 1 than the fit is precise: ranges are
  /// too long (above) or too short, or the board is another.
  double size_ratio = 1.0;
};

/// Robust least squares of the edge points' distances to their sides, over position and angle. The
/// residual's sigma is that of one step along the ring, seen across the side, and the beam's width;
/// how far the beam makes the board grow is taken off and in doubt for all edges alike.
///
/// The board hangs from corner 0: angles within 45 degrees of that are tried, so that a square
/// board has one answer. None for fewer than four edge points and where a direction is left open
/// (all edges parallel to each other).
std::optional<RectangleFit> FitRectangle(std::span<const EdgePoint> edges, const Board& board);

}  // namespace sextant
