// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/corner_geometry.h"

#include <fmt/core.h>

#include <array>

namespace sextant {
namespace {

constexpr std::array<const char*, 4> kSideNames = {"top to right", "right to bottom",
                                                   "bottom to left", "left to top"};

}  // namespace

int SidesOf(const Board& board) { return board.hole ? 2 * kCornersPerBoard : kCornersPerBoard; }

Expected<std::vector<std::vector<int>>> GroupBySide(const BoardPatch& patch, const Board& board) {
  constexpr std::size_t kNeeded = 2;
  std::vector<std::vector<int>> groups(static_cast<std::size_t>(SidesOf(board)));
  for (std::size_t i = 0; i < patch.edges.size(); ++i) {
    if (patch.fit.sides[i] < 0 || patch.fit.sides[i] >= SidesOf(board)) continue;
    if (patch.edges[i].across) continue;
    groups[static_cast<std::size_t>(patch.fit.sides[i])].push_back(static_cast<int>(i));
  }
  for (std::size_t side = 0; side < groups.size(); ++side) {
    if (groups[side].size() >= kNeeded) continue;
    return MakeError(
        ErrorCode::kTooFewPairs,
        fmt::format("board {}: {} rings cross its {}edge from {}, {} are needed: rotate the board "
                    "so that no edge is parallel to the rings, move it closer, or use the "
                    "extractor rectangle",
                    board.id, groups[side].size(), side >= kCornersPerBoard ? "inner " : "",
                    kSideNames[side % kCornersPerBoard], kNeeded));
  }
  return groups;
}

Eigen::Matrix3d MovedByPlane(const LidarPlane& plane, const Eigen::Vector2d& center,
                             const Eigen::Vector2d& in_plane) {
  const Eigen::Vector3d ray = plane.At(center).normalized();
  const Eigen::RowVector3d center_offset(1.0, center.x(), center.y());
  const Eigen::Vector2d arm = in_plane - center;
  const Eigen::RowVector3d tilt(0.0, arm.x(), arm.y());
  return ray / plane.normal.dot(ray) * center_offset + plane.normal * tilt;
}

CornerChecks ChecksOf(const BoardPatch& patch, const Board& board,
                      std::span<const Eigen::Vector3d> corners) {
  const auto sides = static_cast<std::size_t>(SidesOf(board));
  CornerChecks checks;
  checks.points_per_edge.assign(sides, 0);
  checks.line_gaps_m.assign(sides, 0.0);
  checks.plane_sigma_m = patch.plane.sigma_m;
  for (const int side : patch.fit.sides) {
    if (side >= 0 && side < SidesOf(board))
      ++checks.points_per_edge[static_cast<std::size_t>(side)];
  }
  for (std::size_t i = 0; i < sides; ++i) {
    const std::size_t next = i / 4 * 4 + (i + 1) % 4;
    checks.edge_lengths_m.push_back((corners[next] - corners[i]).norm());
  }
  return checks;
}

}  // namespace sextant
