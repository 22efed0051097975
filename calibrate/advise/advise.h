// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/advise/predict_view.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// Where to hold a board next, and the accuracy predicted from it.
struct BoardProposal {
  std::size_t board = 0;  ///< Index into the result's boards.
  Rigid3d cam_from_board{};
  int rings = 0;           ///< Rings that would cross the board.
  Matrix6d information{};  ///< Predicted of this view.
  Matrix6d covariance{};   ///< Predicted for the pose with this view added.
  std::string sentence{};  ///< Distance, side, height and tilt in words.
};

/// Predicted covariance with all views up to this one.
struct KnownAfter {
  int view = 0;  ///< ResultView::view.
  Matrix6d covariance{};
};

struct Advice {
  std::optional<Matrix6d>
      covariance{};                 ///< Predicted from the present views; none: not determined.
  int views = 0;                    ///< Number of views in it.
  std::vector<KnownAfter> after{};  ///< From the first view on that determines the pose.
  BoardProposal proposal{};
  int considered = 0;                   ///< Number of grid poses that both sensors would see.
  std::vector<std::string> warnings{};  ///< See DegenerateSets.
};

/// Proposes the next board pose from a grid: the one that both sensors would see and that minimises
/// the determinant of the predicted covariance (D-optimality: Pukelsheim 1993). The grid covers the
/// image at ranges of 1.2 to 5 m, with the board turned and tilted by up to 40 degrees, with one
/// corner up.
///
/// The information of the present views is taken from the result or, where the file does not have
/// it, predicted from the poses of their boards. `sensors` are those of the result.
/// Errors: kMissingData for a result without boards, a camera without its image size, or a LiDAR
/// without rings; kDegenerate where both sensors see no pose of the grid.
Expected<Advice> Advise(const CalibrationResult& result, const SensorPair& sensors);

/// Who sees the board that DescribePlacement describes.
struct PlacementObserver {
  std::string name = "the camera";
  bool corner_up = true;  ///< Whether the sentence states that a corner is up.
};

/// "Hold board 1 1.8 m in front of the camera, 0.4 m to its right ...".
std::string DescribePlacement(const Board& board, const Rigid3d& cam_from_board,
                              const PlacementObserver& observer = {});

/// Warnings about degenerate sets of board poses: all parallel (within 10 degrees), all at one
/// range (within a tenth), all in one direction (within 10 degrees). Empty for fewer than two.
std::vector<std::string> DegenerateSets(const std::vector<Rigid3d>& cam_from_board);

}  // namespace sextant
