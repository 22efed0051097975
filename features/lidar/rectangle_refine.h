// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "features/lidar/edge_points.h"
#include "features/lidar/rectangle_fit.h"
#include "geometry/board.h"

namespace sextant {

/// Center and angle of a rectangle, and by how much each of its sides appears further out [m].
using RectanglePlacement = Eigen::Vector4d;

/// Fewer edge points do not place a board.
inline constexpr int kMinEdgesOfFit = 4;
/// Sigmas beyond which an edge point is ignored, as one of hands or of a stand.
inline constexpr double kReachOfFit = 8.0;

/// Moves a placement to the nearest minimum of the sum of Huber's losses of the edge points'
/// distances, each truncated at `reach` sigmas, by at most `iterations` steps of least squares.
/// Returns that sum with kReachOfFit. FitRectangles documents sigmas, growth and excess.
double ImprovePlacement(std::span<const EdgePoint> edges, const Board& board, int iterations,
                        double reach, RectanglePlacement& placement);

/// The fit at a minimum: the position along an axis that no ring crosses, which edge point is on
/// which side, and the covariance. None where fewer than kMinEdgesOfFit edge points are on a side,
/// or a direction is left undetermined.
std::optional<RectangleFit> FinishPlacement(std::span<const EdgePoint> edges, const Board& board,
                                            const RectanglePlacement& placement, double cost);

/// The angle of the board's x axis in a plane at which corner 0 is straight up.
double AngleWithCornerUp(const Board& board);

}  // namespace sextant
