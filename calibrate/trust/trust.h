// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"
#include "io/results/calibration_result.h"
#include "solvers/core/solver.h"

namespace sextant {

struct TrustOptions {
  int folds = 10;  ///< Groups of views; each view its own where there are no more than that.
  int bootstrap_samples = 200;
  double level = 0.95;  ///< Of the bootstrap interval.
  std::uint64_t seed = 1;
};

/// How the corners of one view fit, in root mean square; none where it has no such pairs.
struct ViewTrust {
  int view = 0;
  std::optional<double> rmse_m{};  ///< Under the answer.
  std::optional<double> rmse_px{};
  std::optional<double> held_out_m{};  ///< Under the answer of the views of other folds.
  std::optional<double> held_out_px{};
  bool outlier = false;
};

struct Trust {
  TrustFigures figures{};
  std::vector<ViewTrust> views{};  ///< Ascending.
};

/// Holds the views of a problem against each other, with the solver that gave `answer`.
///
/// Cross-validation: view i of the ascending list is in fold i mod folds; every fold is measured
/// under the answer of the others. Their answers theta_j also give the jackknife of groups, (g - 1)
/// / g sum (theta_j - mean)^2 (Shao and Tu 1995). Bootstrap: the views drawn anew with replacement
/// (Efron 1979), the interval by percentiles. Both say what the data itself says of the answer, the
/// covariance what its stated noise does; neither depends on the other.
///
/// Outliers: a view whose held-out error is over twice the median and over 4 scaled MAD (1.4826)
/// beyond it; the others then answer again, and all are judged under that, until nothing changes.
/// Needs four views.
///
/// In parallel; the same on any number of threads. One view alone leaves the figures empty but for
/// the covariance's. Errors: kMissingData where the problem has no view.
Expected<Trust> AssessTrust(const CalibrationProblem& problem, const Solver& solver,
                            const SolveReport& answer, const TrustOptions& options = {});

/// Writes the figures into the result and into those of its views that are judged, and a warning
/// for each that does not belong.
void AddTrust(const Trust& trust, CalibrationResult& result);

}  // namespace sextant
