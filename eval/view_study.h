// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "eval/simulate_views.h"
#include "solvers/solver.h"

namespace sextant {

/// One solver on sessions of raw board views, against the Cramer-Rao bound of the raw data.
struct ViewResult {
  std::string solver;
  int views = 0;
  int trials = 0;
  int unanswered = 0;  ///< An error instead of a pose; not in the figures below.
  /// Root mean squares, and of the bound over the same sessions.
  double rotation_rad = 0.0;
  double translation_m = 0.0;
  double bound_rotation_rad = 0.0;
  double bound_translation_m = 0.0;
  /// Mean of e^T C^-1 e / 6 with the covariance that the solver states: 1 if it is honest. Over
  /// `trials` sessions its standard error is sqrt(1 / (3 trials)).
  double nees = 0.0;

  double RotationRatio() const { return rotation_rad / bound_rotation_rad; }
  double TranslationRatio() const { return translation_m / bound_translation_m; }
};

struct ViewStudy {
  std::uint64_t seed = 1;
  int trials = 500;
  int threads = 2;
  ViewSimulation simulation{};                ///< Its seed and views are set for each trial.
  std::function<void()> after_trial = [] {};  ///< Called from any thread, for progress.
};

/// Every solver on the same sessions of that many views; two-stage solvers get the corners that
/// SimulateViews makes of the same data. The figures do not depend on the number of threads.
/// Errors: those of SimulateViews.
Expected<std::vector<ViewResult>> StudyViews(const ViewStudy& study, int views,
                                             std::span<const SolverPtr> solvers);

}  // namespace sextant
