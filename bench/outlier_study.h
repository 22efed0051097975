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

/// A method that estimates a pose from the camera and 2D-3D pairs, or reports that there is none.
/// Called from several threads.
struct Contestant {
  std::string name;
  std::function<std::optional<Rigid3d>(const CalibrationProblem&)> find;
  bool knows_inliers = false;  ///< Gets only the true pairs: the success that noise alone allows.
};
Contestant ContestantOf(const SolverPtr& solver);
Contestant ContestantThatKnowsInliers(const SolverPtr& solver);

/// Random scenes in which some pairs are mismatched (see MismatchPairs): noise of 1 px at f = 700
/// px, points in a cube of 2 m at 3 m distance.
struct OutlierStudy {
  std::uint64_t seed = 1;
  double sigma_px = 1.0;
  bool states_noise = true;  ///< Whether the pairs state sigma_px.
  int scenes = 100;          ///< Number of scenes per cell.
  int threads = 2;
  std::vector<int> pairs = {20, 100, 500};
  std::vector<double> outlier_fractions = {0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7};
  std::function<void()> after_scene = [] {};  ///< Called from any thread, for progress.
};

/// Error limits of a success [rad], [m].
inline constexpr double kSuccessRotation = 0.5 * 0.017453292519943295;  // 0.5 degrees
inline constexpr double kSuccessTranslation = 0.05;

/// Results of one contestant for one number of pairs and fraction of outliers.
struct OutlierCell {
  std::string contestant;
  int pairs = 0;
  double outlier_fraction = 0.0;
  int scenes = 0;
  int successes = 0;
  int unanswered = 0;  ///< No pose returned, which is better than a wrong one.
};

/// Runs all contestants on the same scenes. Cells are ordered by pairs, then contestants, then
/// fractions. The results do not depend on the number of threads.
std::vector<OutlierCell> StudyOutliers(const OutlierStudy& study,
                                       std::span<const Contestant> contestants);

/// Table of the cells with this number of pairs, one row per contestant: successes, and wrong poses
/// in parentheses.
TextTable OutlierTable(std::span<const OutlierCell> cells, int pairs);

}  // namespace sextant
