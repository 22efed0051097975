// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "features/lidar/board_finder.h"
#include "features/lidar/corner_extractor.h"

// Geometry shared by the corner extractors.
namespace sextant {

/// 4 sides, or 8 of a hollow board.
int SidesOf(const Board& board);

/// The sides that meet at a corner: those before and after it, clockwise.
inline int SideBefore(int corner) { return corner / 4 * 4 + (corner + 3) % 4; }
inline int SideAfter(int corner) { return corner; }

/// The edge points of each side, as indices into patch.edges.
/// Error: kTooFewPairs if a side has fewer than two.
Expected<std::vector<std::vector<int>>> GroupBySide(const BoardPatch& patch, const Board& board);

/// Derivative of a point at `in_plane` by the plane's offset and slopes (3x3). The point moves
/// along the ray to the board's centre, because edges are rays intersected with the plane, and with
/// the plane's tilt about that centre.
Eigen::Matrix3d MovedByPlane(const LidarPlane& plane, const Eigen::Vector2d& center,
                             const Eigen::Vector2d& in_plane);

/// Edge lengths and counts; the gaps are zero.
CornerChecks ChecksOf(const BoardPatch& patch, const Board& board,
                      std::span<const Eigen::Vector3d> corners);

Expected<LidarCorners> CornersByLines3d(const BoardPatch& patch, const Board& board, bool refit);
Expected<LidarCorners> CornersByPlaneLines(const BoardPatch& patch, const Board& board);
Expected<LidarCorners> CornersByRectangle(const BoardPatch& patch, const Board& board);

}  // namespace sextant
