// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "calibrate/observe/observe.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// A board that both sensors saw, as one choice among the candidate associations of its view.
struct MatchedBoard {
  int view = 0;             ///< PairId::view and BoardView::view of its data.
  int sighting = 0;         ///< Index into Observation::in_image.
  int patch = 0;            ///< Index into Observation::in_scan.
  int placement = 0;        ///< Index into LidarSighting::placements; same board as the sighting.
  bool other_pose = false;  ///< Uses pose.ambiguous_with of the sighting instead of its pose.
};

/// The raw observations of a matched board, for the joint solver.
BoardView MakeBoardView(const Observation& observation, const MatchedBoard& match,
                        std::span<const Board> boards);

/// Appends the four outer corners of a matched board as 3D-3D pairs, with the sum of both sensors'
/// covariances, and as 2D-3D pairs, whose pixel is the projection of the corner by the camera's
/// pose of the board, with a sigma that covers both sensors. The rotation of `cam_from_lidar`
/// brings the LiDAR's covariance into the camera frame. Corners that do not project get no 2D-3D
/// pair.
void AppendPairs(const Observation& observation, const MatchedBoard& match,
                 std::span<const Board> boards, const Rigid3d& cam_from_lidar,
                 CalibrationProblem& problem);

}  // namespace sextant
