// SPDX-License-Identifier: Apache-2.0
#include "calibrate/rig/scan_as_image.h"

#include <algorithm>

#include "calibrate/match/matched_board.h"

namespace sextant {
namespace {

// The outer corners alone, as of an image.
PointsInCam OuterCorners(const LidarCorners& corners) {
  PointsInCam points;
  points.points.assign(corners.in_lidar.begin(), corners.in_lidar.begin() + kCornersPerBoard);
  constexpr int kNumbers = 3 * kCornersPerBoard;
  points.covariance = corners.covariance.topLeftCorner<kNumbers, kNumbers>();
  return points;
}

bool IsKnown(const Rigid3d& pose, std::span<const Rigid3d> known) {
  return std::ranges::any_of(known, [&](const Rigid3d& other) {
    return other.translation == pose.translation &&
           other.rotation.coeffs() == pose.rotation.coeffs();
  });
}

}  // namespace

ScanAsImage AsImage(const Observation& scan, std::span<const Rigid3d> known) {
  ScanAsImage as_image;
  for (std::size_t p = 0; p < scan.in_scan.size(); ++p) {
    const std::vector<BoardPlacement>& placements = scan.in_scan[p].placements;
    std::size_t chosen = 0;
    for (std::size_t k = 0; k < placements.size(); ++k) {
      if (IsKnown(placements[k].lidar_from_board, known)) chosen = k;
    }
    const BoardPlacement& best = placements[chosen];
    CameraSighting sighting{.board = best.board, .corners = OuterCorners(best.corners)};
    sighting.pose.cam_from_board = best.lidar_from_board;
    // The scatter of the corners over the board's size is that of the angle.
    const double variance = sighting.corners.covariance.trace() / (3.0 * kCornersPerBoard);
    sighting.pose.covariance.diagonal().head<3>().setConstant(
        variance / (sighting.corners.points[0] - sighting.corners.points[2]).squaredNorm());
    sighting.pose.covariance.diagonal().tail<3>().setConstant(variance);
    as_image.image.in_image.push_back(std::move(sighting));
    as_image.sources.emplace_back(static_cast<int>(p), static_cast<int>(chosen));
  }
  return as_image;
}

BoardView ViewOfSighting(const Observation& scan, const ScanAsImage& as_image, int sighting,
                         std::span<const Board> boards) {
  Observation both{.in_image = as_image.image.in_image, .in_scan = scan.in_scan};
  const auto& [patch, placement] = as_image.sources[static_cast<std::size_t>(sighting)];
  return MakeBoardView(
      both, {.view = 0, .sighting = sighting, .patch = patch, .placement = placement}, boards);
}

}  // namespace sextant
