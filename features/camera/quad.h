// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace sextant {

using Quad = std::array<Eigen::Vector2d, 4>;  ///< Corners in order around the quadrilateral.

/// Positive if the corners go clockwise as seen, with y down. [px^2]
double SignedArea(const Quad& quad);

/// The same quad, beginning at its corner number `first`.
Quad StartingAt(const Quad& quad, int first);

struct Line2 {
  Eigen::Vector2d normal = Eigen::Vector2d::UnitX();  ///< Unit length.
  double offset = 0.0;                                ///< normal . point = offset.
};
Line2 LineThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b);
/// The intersection; none for lines that are parallel to 1e-6 rad.
std::optional<Eigen::Vector2d> Intersect(const Line2& a, const Line2& b);

/// The quad with each edge moved outward by `extents` times the extent of a pixel across it,
/// max(|n_x|, |n_y|), which is twice the distance between an edge and the centres of the pixels
/// next to it. The quad itself if its edges are degenerate.
Quad MoveEdgesOut(const Quad& quad, double extents);

/// The homography that maps the unit square's corners (0,0), (1,0), (1,1), (0,1) to the quad's;
/// none for a quad that is not convex.
std::optional<Eigen::Matrix3d> UnitSquareToQuad(const Quad& quad);

}  // namespace sextant
