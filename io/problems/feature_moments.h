// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/board.h"
#include "io/problems/feature_table.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// A board with the points on it that observations may refer to.
struct FeatureBoard {
  Board board;
  std::vector<Eigen::Vector2d> points;  ///< By default its four outer corners.
  bool has_size = true;                 ///< False: its size is that of the points, it has no sides.
};

/// Standard deviation of a pixel that states none.
inline constexpr double kUsualSigma_px = 0.3;
/// Most points of a board in one observation, whose covariance takes the square of it.
inline constexpr int kMaxPointsSeen = 1000;
/// What is recorded within this time is one moment, in which a board moves with constant velocity.
inline constexpr double kMoment_s = 0.2;

struct FeatureTable {
  std::string file;  ///< For messages.
  std::vector<FeatureRow> rows;
};

/// Adds the observations of tables to a problem. Rows of one moment, board, sensor and time are one
/// observation; rows without a moment are taken together by their times, kMoment_s each, over all
/// tables.
/// Errors: kParse with file and line, for names, corners and sides that do not exist, and for what
/// is stated twice.
Expected<void> AddFeatures(std::vector<FeatureTable> tables,
                           const std::map<int, FeatureBoard>& boards, RigProblem& problem);

}  // namespace sextant
