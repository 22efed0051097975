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
  double angle_rad = 0.0;                                ///< Angle of the board's x axis.
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< Order: center, angle.
  /// For each edge point the side that it lies on: 0 between the corners 0 and 1, then clockwise, 4
  /// to 7 for the opening, from kFirstRim on the rims of round holes; -1 if it lies on none.
  std::vector<int> sides;
  std::vector<double> sigmas_m;          ///< For each edge point, across its nearest side.
  std::vector<Eigen::Vector2d> on_edge;  ///< Each edge point without the growth by the beam [m].
  double cost = 0.0;                     ///< Sum of the truncated Huber losses of all edge points.
  double rms = 0.0;    ///< RMS of the residuals of edge points on a side, in sigmas.
  double rms_m = 0.0;  ///< The same in metres, across the edge.
  double share = 0.0;  ///< Fraction of the edge points that lie on a side.
  int sides_seen = 0;  ///< Number of outer sides with edge points.
  int rims_seen = 0;   ///< Number of round holes with edge points on three quarters of their rim.
  /// Size of the outline relative to the board's. A significant deviation from 1 means that ranges
  /// are too long (above) or too short, or that it is another board.
  double size_ratio = 1.0;
};

/// Fits the position and the angle of the board by robust least squares of the edge points'
/// distances to their sides, from the starts of RectangleStarts. The sigma of a residual comes from
/// one step along the ring, projected across the side, and from the beam's width. The growth by the
/// beam is subtracted; its uncertainty is common to all edges. So is an excess of the outline over
/// the stated size, of one percent (1 sigma), which keeps a board that appears too large or too
/// small between its sides.
///
/// Where no ring crosses the two sides of an axis, the position along it is the middle of the
/// interval in which the board contains all of its edge points' returns and ends before the rings
/// beyond it, with the variance of a uniform error over that interval.
///
/// The points of round holes' rims are treated alike: the excess makes a hole smaller.
///
/// Returns distinct fits by ascending cost, at most `max_count`. A rectangle looks the same after
/// half a turn, unless its openings do not, and a square after a quarter; of these angles, the
/// one is stated at which corner 0 is highest. `starts`: further placements to start from. Empty
/// for fewer than four edge points and where they leave a direction undetermined by more than 15 %
/// of half the board's diagonal (1 sigma).
std::vector<RectangleFit> FitRectangles(std::span<const EdgePoint> edges, const Board& board,
                                        std::size_t max_count,
                                        std::span<const Eigen::Vector3d> starts = {});

/// Index of the placement to state: of those that fit as well as the best (likelihood ratio over
/// 1 %), as the two of a board that is nearly square, the one with corner 0 highest. Requires one.
std::size_t MostUpright(std::span<const RectangleFit> fits, const Board& board);

/// That placement of FitRectangles.
std::optional<RectangleFit> FitRectangle(std::span<const EdgePoint> edges, const Board& board,
                                         std::span<const Eigen::Vector3d> starts = {});

/// The fit nearest to a known placement.
std::optional<RectangleFit> RefineRectangle(std::span<const EdgePoint> edges, const Board& board,
                                            const Eigen::Vector2d& center, double angle_rad);

}  // namespace sextant
