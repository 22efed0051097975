// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/p3p_start.h"

#include <algorithm>
#include <array>
#include <limits>

#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pixel_sums.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxCorners = 5;
constexpr std::size_t kMaxBlocks = 4;
constexpr std::size_t kMaxTerms = kMaxBlocks * kSimdWidth;

// Triples of five corners, chosen so that each corner is used about equally often.
constexpr std::size_t kTriples[kSimdWidth][3] = {{0, 1, 2}, {0, 1, 3}, {0, 2, 3}, {1, 2, 3},
                                                 {0, 1, 4}, {0, 2, 4}, {1, 2, 4}, {0, 3, 4}};

// The number of triples that use only the first `corners` corners.
std::size_t TriplesOf(std::size_t corners) {
  return corners < 4 ? 1 : corners == 4 ? 4 : kSimdWidth;
}

// A subset of the terms, evenly spread.
struct FewTerms {
  explicit FewTerms(PixelTermsView all) {
    const std::span<const PixelBlock> from = all.blocks();
    if (from.size() <= kMaxBlocks) {
      view = all;
      return;
    }
    // The last block may not be full.
    for (std::size_t i = 0; i < kMaxBlocks; ++i)
      blocks[i] = from[i * (from.size() - 1) / kMaxBlocks];
    view = {blocks.data(), kMaxTerms};
  }

  std::array<PixelBlock, kMaxBlocks> blocks;
  PixelTermsView view;
};

// Terms far apart in the image: the one farthest from the centre, then repeatedly the one farthest
// from those chosen; of equal ones the first.
std::size_t SpreadTerms(PixelTermsView terms, std::array<std::size_t, kMaxCorners>& chosen) {
  std::array<double, kMaxTerms> distances;
  const auto farthest_from = [&](double u, double v, bool is_first) {
    std::size_t i = 0;
    std::size_t farthest = 0;
    for (const PixelBlock& block : terms.blocks()) {
      for (std::size_t k = 0; k < kSimdWidth; ++k, ++i) {
        const double du = block.u[k] - u;
        const double dv = block.v[k] - v;
        const double squared = du * du + dv * dv;
        distances[i] = is_first ? squared : std::min(distances[i], squared);
      }
    }
    for (i = 1; i < terms.size(); ++i) farthest = distances[i] > distances[farthest] ? i : farthest;
    return farthest;
  };
  double u = 0.0;
  double v = 0.0;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    u += terms.blocks()[i / kSimdWidth].u[i % kSimdWidth];
    v += terms.blocks()[i / kSimdWidth].v[i % kSimdWidth];
  }
  const auto count = static_cast<double>(terms.size());
  std::size_t next = farthest_from(u / count, v / count, true);
  const std::size_t corners = std::min(kMaxCorners, terms.size());
  for (std::size_t i = 0; i < corners; ++i) {
    chosen[i] = next;
    const Eigen::Vector2d pixel = terms[next].pixel;
    next = farthest_from(pixel.x(), pixel.y(), i == 0);
  }
  return corners;
}

Eigen::Vector3d RayOf(const PixelTerm& term, const Camera& camera) {
  return Eigen::Vector3d((term.pixel.x() - camera.cx_px) / camera.fx_px,
                         (term.pixel.y() - camera.cy_px) / camera.fy_px, 1.0)
      .normalized();
}

void Place(const Eigen::Vector3d& ray, const Eigen::Vector3d& point, std::size_t to, std::size_t k,
           P3pTriples& triples) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    triples.rays[3 * to + axis][k] = ray[static_cast<Eigen::Index>(axis)];
    triples.points[3 * to + axis][k] = point[static_cast<Eigen::Index>(axis)];
  }
}

}  // namespace

std::optional<Rigid3d> StartFromTriples(PixelTermsView terms, const Camera& camera) {
  const FewTerms few(terms);
  std::array<std::size_t, kMaxCorners> corners{};
  const std::size_t corner_count = SpreadTerms(few.view, corners);
  const std::size_t triple_count = TriplesOf(corner_count);
  std::array<Eigen::Vector3d, kMaxCorners> rays;
  std::array<Eigen::Vector3d, kMaxCorners> points;
  for (std::size_t i = 0; i < corner_count; ++i) {
    const PixelTerm term = few.view[corners[i]];
    rays[i] = RayOf(term, camera);
    points[i] = term.in_lidar;
  }
  P3pTriples triples;
  for (std::size_t k = 0; k < kSimdWidth; ++k) {
    // Unused elements of the vector repeat a triple.
    const auto& triple = kTriples[k < triple_count ? k : 0];
    for (std::size_t to = 0; to < 3; ++to) {
      Place(rays[triple[to]], points[triple[to]], to, k, triples);
    }
  }
  P3pPoses poses;
  SolveP3pBatch(triples, poses);
  // Cost of a point behind the camera: finite, but above that of any pose with all points in front.
  constexpr double kBehind = 1e12;
  double least = std::numeric_limits<double>::infinity();
  std::optional<std::array<std::size_t, 2>> best;
  for (std::size_t c = 0; c < kMaxP3pPoses; ++c) {
    for (std::size_t k = 0; k < triple_count; ++k) {
      if (poses.exists[c][k] == 0) continue;
      const double cost =
          TruncatedPixelCost(few.view.blocks(), PinholePose(camera, poses, c, k), kBehind, least);
      if (!(cost < least)) continue;
      least = cost;
      best = {c, k};
    }
  }
  if (!best) return std::nullopt;
  return poses.Pose((*best)[0], (*best)[1]);
}

}  // namespace sextant
