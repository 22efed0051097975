// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/face_returns.h"

#include <cmath>
#include <optional>

#include "features/lidar/board_agreement.h"

namespace sextant {

FaceOfBoard FaceReturns(const ScanRings& scan, const BoardPatch& patch,
                        std::span<const Board> boards) {
  const Board& board = boards[static_cast<std::size_t>(patch.board)];
  FaceOfBoard face;
  for (const std::size_t place : patch.on_plane) {
    const Eigen::Vector3d& point = scan.points()[place].point;
    const std::optional<Eigen::Vector2d> in_plane = patch.plane.Meet(point);
    if (!in_plane || BeyondBoard(patch.fit, board, *in_plane) >= 0.0) continue;
    face.in_lidar.push_back(point);
    if (scan.has_rings()) face.rings.push_back(scan.number(scan.RingOf(place)));
  }
  return face;
}

double RangeSigma(std::span<const Eigen::Vector3d> face, const LidarPlane& plane) {
  constexpr double kPlaneUnknowns = 3.0;
  double squares = 0.0;
  for (const Eigen::Vector3d& point : face) {
    const double along = plane.normal.dot(point.normalized());
    const double off = plane.normal.dot(point - plane.origin) / along;
    squares += off * off;
  }
  const double freedom = static_cast<double>(face.size()) - kPlaneUnknowns;
  return freedom > 0.0 ? std::sqrt(squares / freedom) : plane.sigma_m;
}

}  // namespace sextant
