// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/calibration_problem.h"

namespace sextant {

struct SolveReport;
struct SolverSpec;

/// Widens the covariance of an answer whose pairs state less noise than most of them show (the
/// scale factor of Birge 1932), with a warning.
///
/// At the least-squares minimum next to the answer, k is the smaller of two ratios: of the RMS of
/// the whitened residuals of the pairs used to what their degrees of freedom leave of 1, and of
/// their median to that of chi with 3 or 2 degrees of freedom, in which outliers count little.
/// Where k exceeds 1.25 and chance does not explain the sum of squares (chi-square, probability
/// below 1e-4), the covariance is multiplied by k^2. Stated noise that is too large stays: that
/// the residuals are small may be chance, and errors that all pairs share leave none.
///
/// Nothing changes for pairs that state no noise, solvers of both kinds of pairs or of raw
/// observations, solvers that estimate a camera, and fewer than six degrees of freedom. Time O(n).
void WidenUnderstatedNoise(const CalibrationProblem& problem, const SolverSpec& spec,
                           SolveReport& report);

}  // namespace sextant
