// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "geometry/calibration_problem.h"
#include "io/results/calibration_result.h"
#include "solvers/core/solver.h"

namespace sextant {

struct TrustOptions {
  int folds = 10;  ///< Groups of views; one view per group where there are at most this many.
  int bootstrap_samples = 200;
  double level = 0.95;  ///< Confidence level of the bootstrap interval.
  std::uint64_t seed = 1;
  /// Groups of views that share their errors and are left out or drawn together; a view in none of
  /// them is a group of its own.
  std::vector<std::vector<int>> together{};
  ProgressCallback progress{};  ///< Stage "bootstrap": solutions without a fold, and of samples.
};

/// RMS residual of one view's corners; none where it has no pairs of that kind.
struct ViewTrust {
  int view = 0;
  std::optional<double> rmse_m{};  ///< Under the answer from all views.
  std::optional<double> rmse_px{};
  std::optional<double> held_out_m{};  ///< Under the pose from the other folds.
  std::optional<double> held_out_px{};
  bool outlier = false;
};

struct Trust {
  TrustFigures figures{};
  std::vector<ViewTrust> views{};  ///< Ascending.
  int independent_views = 0;       ///< Groups of views that share no errors.
  /// The covariance of the answer, enlarged to what the views show (StatedCovariance).
  std::optional<Matrix6d> covariance{};
  std::optional<double> halves_off{};  ///< HalvesDisagreement.
};

/// Tests how consistent the views of a problem are, with the solver that gave `answer`.
///
/// Cross-validation: view i of the ascending list is in fold i mod folds; the residuals of each
/// fold are taken under the pose theta_j of the other folds. The same poses give the grouped
/// jackknife variance (g - 1) / g sum (theta_j - mean)^2 (Shao and Tu 1995). Bootstrap over views:
/// resampling with replacement (Efron 1979), percentile intervals. Jackknife and bootstrap measure
/// the scatter of the data; the covariance propagates its stated noise, so the two are independent
/// checks.
///
/// Outliers: DisagreeingViews of the raw observations where the problem has these, else
/// OutlyingViews of the held-out errors; the others are then solved again and all views are tested
/// under that pose, until nothing changes.
///
/// Halves in the order of the views: HalvesDisagreement, a test for a sensor that moved.
///
/// Runs in parallel; the result does not depend on the number of threads. With a single view only
/// the covariance's figures are set. Errors: kMissingData where the problem has no view.
Expected<Trust> AssessTrust(const CalibrationProblem& problem, const Solver& solver,
                            const SolveReport& answer, const TrustOptions& options = {});

/// Copies the figures into the result and its views, and adds a warning for each
/// outlier that is kept.
void AddTrust(const Trust& trust, CalibrationResult& result);

}  // namespace sextant
