// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace sextant {

using Quad = std::array<Eigen::Vector2d, 4>;  ///< Corners in order round it.

/// Positive where the corners go clockwise as seen, with y down. [px^2]
double SignedArea(const Quad& quad);

/// Whose first corner is this one's corner number `first`.
Quad StartingAt(const Quad& quad, int first);

struct Line2 {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< Unit length.
  double offset = 0.0;                                ///< normal . point = offset.
};
Line2 LineThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b);
/// None for lines that are parallel to 1e-6 rad.
std::optional<Eigen::Vector2d> Intersect(const Line2& a, const Line2& b);

/// The quad with each edge moved outward by `extents` times the extent of a pixel across it,
/// max(|n_x|, |n_y|): what lies between an edge and the centres of the pixels next to it, twice
/// over. The quad itself where its edges are degenerate.
Quad MoveEdgesOut(const Quad& quad, double extents);

/// The homography with the unit square's corners (0,0), (1,0), (1,1), (0,1) at the quad's; none for
/// a quad that is not convex.
std::optional<Eigen::Matrix3d> UnitSquareToQuad(const Quad& quad);

}  // namespace sextant
