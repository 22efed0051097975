// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/match/assemble.h"
#include "calibrate/observe_session.h"
#include "calibrate/options.h"
#include "calibrate/session/session.h"
#include "calibrate/trust/trust.h"
#include "eval/metrics/compare.h"
#include "io/problems/problem_yaml.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// A calibration with every intermediate product. Members behind the first stage that failed keep
/// their defaults, and `result` has that stage's error.
struct Calibration {
  ObservedSession observed{};    ///< Views with the boards in them, or their errors.
  CalibrationProblem problem{};  ///< What the solvers were given.
  /// The data that the answer rests on: the problem without the boards that the first solver left
  /// out. With the status of each board.
  Assembly assembly{};
  /// One row per solver, in the order of CalibrateOptions::solvers, with the distances to the first
  /// solver's pose and to the session's true pose, where known.
  std::vector<ComparisonRow> comparison{};
  /// What is noteworthy in the data, one sentence each: ambiguities, files without a partner,
  /// contradictions between views, board file and intrinsics, outlying views. The same as the
  /// result's, but there without a result, too.
  std::vector<std::string> warnings{};
  std::optional<Trust> trust{};  ///< None with bootstrap_samples = 0.
  /// cam_from_lidar with covariance, residuals of each view, information, trust and configuration:
  /// what FormatCalibrationResult writes. An error where no pose was found: kMissingData where no
  /// view shows a board to both sensors, those of Assemble, and those of the first solver.
  Expected<CalibrationResult> result{};

  /// The first solver's answer; null where it has none.
  const SolveReport* report() const;
};

/// The whole pipeline: observes the boards in every view, matches and assembles them, solves,
/// checks the data and the answer (diagnostics, information of each view, cross-validation,
/// bootstrap). Runs on all cores; the same input gives the same result on any number of them.
/// Prints nothing.
///
/// Errors: those of ObserveSession, for input that cannot be used. Usable input without an answer
/// is a Calibration whose `result` is the error.
Expected<Calibration> Calibrate(const Session& session, const CalibrateOptions& options = {});

/// The same for images and scans in memory; options.boards and options.camera are required.
Expected<Calibration> Calibrate(std::span<const Frame> frames, const CalibrateOptions& options);

/// The stages after observation, for views observed before or elsewhere.
Calibration CalibrateObserved(ObservedSession observed, const CalibrateOptions& options = {});

/// The solvers' problem as FormatProblemYaml writes it, with the session's true pose where known.
/// Requires an assembly.
ProblemFile ProblemFileOf(const Calibration& calibration);

}  // namespace sextant
