// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/matched_board.h"

#include <cmath>
#include <optional>

namespace sextant {
namespace {

struct Parts {
  const CameraSighting& sighting;
  const LidarSighting& patch;
  const BoardPlacement& placement;
};

Parts PartsOf(const Observation& observation, const MatchedBoard& match) {
  const LidarSighting& patch = observation.in_scan[static_cast<std::size_t>(match.patch)];
  return {observation.in_image[static_cast<std::size_t>(match.sighting)], patch,
          patch.placements[static_cast<std::size_t>(match.placement)]};
}

// Standard deviation per axis of the corner's pixel, from the covariance of its position in 3D.
double PixelSigma(const ProjectionWithJacobian& image, const Eigen::Matrix3d& covariance_in_cam) {
  const Eigen::Matrix2d in_pixels =
      image.pixel_by_point * covariance_in_cam * image.pixel_by_point.transpose();
  return std::sqrt(0.5 * in_pixels.trace());
}

}  // namespace

BoardView MakeBoardView(const Observation& observation, const MatchedBoard& match,
                        std::span<const Board> boards) {
  const auto& [sighting, patch, placement] = PartsOf(observation, match);
  BoardView view{.view = match.view,
                 .board = boards[static_cast<std::size_t>(sighting.board)].id,
                 .printed = sighting.printed,
                 .face_in_lidar = patch.face,
                 .face_rings = patch.face_rings,
                 .range_sigma_m = patch.range_sigma_m,
                 .edges = {},
                 .cam_from_board = match.other_pose ? *sighting.pose.ambiguous_with
                                                    : sighting.pose.cam_from_board,
                 .lidar_from_board = placement.lidar_from_board};
  for (std::size_t i = 0; i < patch.edges.size(); ++i) {
    if (placement.fit.sides[i] < 0) continue;
    view.edges.push_back({.direction = patch.plane.At(placement.fit.on_edge[i]).normalized(),
                          .side = placement.fit.sides[i],
                          .sigma_m = placement.fit.sigmas_m[i]});
  }
  return view;
}

void AppendPairs(const Observation& observation, const MatchedBoard& match,
                 std::span<const Board> boards, const Rigid3d& cam_from_lidar,
                 CalibrationProblem& problem) {
  const auto& [sighting, patch, placement] = PartsOf(observation, match);
  const Eigen::Matrix3d turn = cam_from_lidar.rotation.toRotationMatrix();
  for (int corner = 0; corner < kCornersPerBoard; ++corner) {
    const auto k = static_cast<std::size_t>(corner);
    const PairId id{match.view, boards[static_cast<std::size_t>(sighting.board)].id, corner};
    const Eigen::Matrix3d covariance =
        sighting.corners.CovarianceOf(k) +
        turn * placement.corners.CovarianceOf(corner) * turn.transpose();
    const Eigen::Vector3d& in_cam =
        match.other_pose ? sighting.other_corners[k] : sighting.corners.points[k];
    const Eigen::Vector3d& in_lidar = placement.corners.in_lidar[k];
    problem.pairs_3d3d.push_back({.point_in_cam = in_cam,
                                  .point_in_lidar = in_lidar,
                                  .sigma_m = 0.0,
                                  .covariance_in_cam = covariance,
                                  .id = id});
    const auto image = ProjectWithJacobian(*problem.camera, in_cam);
    if (!image) continue;
    problem.pairs_2d3d.push_back({.pixel = image->pixel,
                                  .point_in_lidar = in_lidar,
                                  .sigma_px = PixelSigma(*image, covariance),
                                  .id = id});
  }
}

}  // namespace sextant
