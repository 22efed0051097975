// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/advise/predict_view.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// Where to hold a board next, and what that is foreseen to bring.
struct BoardProposal {
  std::size_t board = 0;  ///< Into the result's boards.
  Rigid3d cam_from_board{};
  int rings = 0;           ///< On the board.
  Matrix6d covariance{};   ///< Of the pose with this view besides those there are.
  std::string sentence{};  ///< Distance, side, height and tilt, for whoever holds it.
};

/// What was known after one of the views that there are.
struct KnownAfter {
  int view = 0;  ///< ResultView::view.
  Matrix6d covariance{};
};

struct Advice {
  std::optional<Matrix6d> covariance{};  ///< Predicted from the views there are; none: too little.
  int views = 0;                         ///< That it rests on.
  std::vector<KnownAfter> after{};       ///< Of each of them from which on the pose is determined.
  BoardProposal proposal{};
  int considered = 0;                   ///< Poses of the grid that both sensors would see.
  std::vector<std::string> warnings{};  ///< Of sets of views that leave something open.
};

/// The pose of a grid that both sensors would see which makes the determinant of the foreseen
/// covariance smallest (D-optimal: Pukelsheim 1993): 1.2 to 5 m away, over the image, turned and
/// leant by up to 40 degrees, hung from a corner.
///
/// The information of the views there are is taken from the result, or foreseen from the poses of
/// their boards where the file does not have it. `sensors` are those of the result.
/// Errors: kMissingData for a result without boards and a camera without its image size or a LiDAR
/// without rings; kDegenerate where no pose of the grid is seen by both sensors.
Expected<Advice> Advise(const CalibrationResult& result, const SensorPair& sensors);

/// "Hold board 1 about 1.8 m in front of the camera, 0.4 m to its right ...".
std::string DescribePlacement(const Board& board, const Rigid3d& cam_from_board);

/// What a set of board poses leaves open: all boards parallel (within 10 degrees), all at one range
/// (within a tenth), all in one direction (within 10 degrees). Empty for fewer than two.
std::vector<std::string> DegenerateSets(const std::vector<Rigid3d>& cam_from_board);

}  // namespace sextant
