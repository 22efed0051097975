// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "eval/metrics/compare.h"
#include "eval/metrics/score.h"
#include "solvers/core/solver.h"

namespace sextant {

/// An answer with its uncertainty and its overall residuals.
std::string DescribeAnswer(const SolveReport& report);

/// Everything that `sextant solve` prints about an answer: the same, and every residual.
std::string DescribeReport(const CalibrationProblem& problem, const SolverSpec& spec,
                           const SolveReport& report);

/// The table of `sextant compare`, one row per solver, and the reasons of solvers without an
/// answer. The RMSE is over the pairs that the answer is based on. Lines have at most 100
/// characters as long as a name has at most 25: the angles of the pose are left out first, then all
/// of it, then the distance to the best answer where that to a truth is known.
std::string DescribeComparison(const std::vector<ScoredRow>& rows);
/// The same in the order given, without scores, and with the RMSE over all pairs.
std::string DescribeComparison(const std::vector<ComparisonRow>& rows);

}  // namespace sextant
