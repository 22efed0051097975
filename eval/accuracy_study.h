// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "eval/random_scene.h"
#include "solvers/solver.h"

namespace sextant {

/// Random scenes of one kind, with part of the pairs replaced by pairs of wrong points.
struct AccuracyCondition {
  std::string name;
  RandomSceneOptions scene;
  double outlier_fraction = 0.0;
};

/// One solver under one condition, against the Cramer-Rao bound of the same scenes' inliers.
struct AccuracyResult {
  std::string solver;
  std::string condition;
  int trials = 0;
  int unanswered = 0;  ///< An error instead of a pose.
  int gross = 0;       ///< Rotation wrong by over kGrossRotation: another pose, not noise.
  /// Root mean squares over the other trials, and of the bound over the same.
  double rotation_rad = 0.0;
  double translation_m = 0.0;
  double bound_rotation_rad = 0.0;
  double bound_translation_m = 0.0;

  double RotationRatio() const { return rotation_rad / bound_rotation_rad; }
  double TranslationRatio() const { return translation_m / bound_translation_m; }
};

inline constexpr double kGrossRotation = 0.35;  // 20 degrees.

struct AccuracyStudy {
  std::uint64_t seed = 1;
  int trials = 2000;
  int threads = 2;
  std::function<void()> after_trial = [] {};  ///< Called from any thread, for progress.
};

/// Every solver on the same `trials` scenes of the condition. The figures do not depend on the
/// number of threads. A solver sees only the kind of data that it needs, and the true pose as its
/// initial one where it needs that.
std::vector<AccuracyResult> StudyAccuracy(const AccuracyStudy& study,
                                          const AccuracyCondition& condition,
                                          std::span<const SolverPtr> solvers);

}  // namespace sextant
