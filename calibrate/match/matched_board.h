// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "calibrate/observe/observe.h"
#include "geometry/calibration_problem.h"

namespace sextant {

/// A board that both sensors saw, and which of what they leave possible is taken.
struct MatchedBoard {
  int view = 0;             ///< Becomes PairId::view and BoardView::view.
  int sighting = 0;         ///< Into Observation::in_image.
  int patch = 0;            ///< Into Observation::in_scan.
  int placement = 0;        ///< Into LidarSighting::placements; of the same board as the sighting.
  bool other_pose = false;  ///< The camera's pose.ambiguous_with instead of the likelier one.
};

/// The raw observations of a matched board, for the joint solver.
BoardView MakeBoardView(const Observation& observation, const MatchedBoard& match,
                        std::span<const Board> boards);

/// Appends its four corners as 3D-3D pairs, with the covariances of both sensors, and as 2D-3D
/// pairs: the pixel in which the camera's pose puts the corner, the sigma of both sensors. The
/// rotation of `cam_from_lidar` turns the LiDAR's covariance into the camera frame. A corner that
/// the camera's model does not reach has no 2D-3D pair.
void AppendPairs(const Observation& observation, const MatchedBoard& match,
                 std::span<const Board> boards, const Rigid3d& cam_from_lidar,
                 CalibrationProblem& problem);

}  // namespace sextant
