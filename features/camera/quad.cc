// SPDX-License-Identifier: Apache-2.0
#include "features/camera/quad.h"

#include <cmath>

namespace sextant {
namespace {

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

double SignedArea(const Quad& quad) { return 0.5 * Cross(quad[2] - quad[0], quad[3] - quad[1]); }

Quad StartingAt(const Quad& quad, int first) {
  Quad turned;
  for (std::size_t k = 0; k < 4; ++k) turned[k] = quad[(k + static_cast<std::size_t>(first)) % 4];
  return turned;
}

Line2 LineThrough(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = (b - a).normalized();
  const Eigen::Vector2d normal(along.y(), -along.x());
  return {normal, normal.dot(0.5 * (a + b))};
}

std::optional<Eigen::Vector2d> Intersect(const Line2& a, const Line2& b) {
  const double sine = Cross(a.normal, b.normal);
  if (std::abs(sine) < 1e-6) return std::nullopt;
  return Eigen::Vector2d((a.offset * b.normal.y() - b.offset * a.normal.y()) / sine,
                         (b.offset * a.normal.x() - a.offset * b.normal.x()) / sine);
}

Quad MoveEdgesOut(const Quad& quad, double extents) {
  const double turn = SignedArea(quad) > 0.0 ? 1.0 : -1.0;
  std::array<Line2, 4> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    edges[i] = LineThrough(quad[i], quad[(i + 1) % 4]);
    edges[i].offset += turn * extents * edges[i].normal.cwiseAbs().maxCoeff();
  }
  Quad moved;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::optional<Eigen::Vector2d> corner = Intersect(edges[(i + 3) % 4], edges[i]);
    if (!corner) return quad;
    moved[i] = *corner;
  }
  return moved;
}

// Heckbert 1989, "Fundamentals of Texture Mapping and Image Warping", section 2.2.3.
std::optional<Eigen::Matrix3d> UnitSquareToQuad(const Quad& quad) {
  const double turn = SignedArea(quad);
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d a = quad[(i + 1) % 4] - quad[i];
    const Eigen::Vector2d b = quad[(i + 2) % 4] - quad[(i + 1) % 4];
    if (!(Cross(a, b) * turn > 0.0)) return std::nullopt;
  }
  const Eigen::Vector2d d1 = quad[1] - quad[2];
  const Eigen::Vector2d d2 = quad[3] - quad[2];
  const Eigen::Vector2d sum = quad[0] - quad[1] + quad[2] - quad[3];
  const double det = Cross(d1, d2);
  const double g = Cross(sum, d2) / det;
  const double h = Cross(d1, sum) / det;
  Eigen::Matrix3d homography;
  homography.col(0) << quad[1] - quad[0] + g * quad[1], g;
  homography.col(1) << quad[3] - quad[0] + h * quad[3], h;
  homography.col(2) << quad[0], 1.0;
  return homography;
}

}  // namespace sextant
