// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "eval/statistics/text_table.h"
#include "solvers/core/solver.h"

namespace sextant {

/// A method that finds a pose from the camera and 2D-3D pairs, or none. Called from several
/// threads.
struct Contestant {
  std::string name;
  std::function<std::optional<Rigid3d>(const CalibrationProblem&)> find;
  bool knows_inliers = false;  ///< Gets the true pairs only: the limit set by noise alone.
};
Contestant ContestantOf(const SolverPtr& solver);
Contestant ContestantThatKnowsInliers(const SolverPtr& solver);

/// Random scenes with part of the pairs mismatched (see MismatchPairs): 1 px at f = 700 px, boxes
/// of 2 m at 3 m.
struct OutlierStudy {
  std::uint64_t seed = 1;
  int scenes = 100;  ///< Per cell.
  int threads = 2;
  std::vector<int> pairs = {20, 100, 500};
  std::vector<double> outlier_fractions = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  std::function<void()> after_scene = [] {};  ///< Called from any thread, for progress.
};

/// Largest errors of a success.
inline constexpr double kSuccessRotation = 0.5 * 0.017453292519943295;  // 0.5 degrees
inline constexpr double kSuccessTranslation = 0.05;

/// The results of one contestant in the scenes of one size and share of outliers.
struct OutlierCell {
  std::string contestant;
  int pairs = 0;
  double outlier_fraction = 0.0;
  int scenes = 0;
  int successes = 0;
  int unanswered = 0;  ///< Scenes without a pose, which is better than a wrong one.
};

/// Cells ordered by pairs, contestant and fraction; all contestants get the same scenes. The
/// results do not depend on the number of threads.
std::vector<OutlierCell> StudyOutliers(const OutlierStudy& study,
                                       std::span<const Contestant> contestants);

/// The cells with `pairs` pairs, one row per contestant: successes, and wrong poses in parentheses.
TextTable OutlierTable(std::span<const OutlierCell> cells, int pairs);

}  // namespace sextant
