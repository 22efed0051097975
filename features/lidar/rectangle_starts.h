// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <span>
#include <vector>

#include "features/lidar/edge_points.h"

namespace sextant {

/// Whether a rectangle of these half sizes looks the same after a quarter turn.
inline bool IsSquare(const Eigen::Vector2d& half) {
  constexpr double kSameSides = 1e-6;
  return std::abs(half.x() - half.y()) < kSameSides * half.x();
}

/// Initial poses (center, angle) of a rectangle of half sizes `half`, likeliest first, from a vote
/// of the edge points, which needs no majority of them: at each of a series of angles, an edge
/// point votes for the centres at which one of the rectangle's sides goes through it. The angles
/// cover half a turn; a quarter for a square. The edge points of an opening are ignored.
std::vector<Eigen::Vector3d> RectangleStarts(std::span<const EdgePoint> edges,
                                             const Eigen::Vector2d& half, std::size_t max_count);

}  // namespace sextant
