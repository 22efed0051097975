// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "eval/metrics/compare.h"
#include "solvers/core/solver.h"

namespace sextant {

/// An answer with its uncertainty and its overall residuals.
std::string DescribeAnswer(const SolveReport& report);

/// Everything that `sextant solve` prints about an answer: the same, and every residual.
std::string DescribeReport(const CalibrationProblem& problem, const SolverSpec& spec,
                           const SolveReport& report);

/// The table of `sextant compare`, one row per solver, and the reasons of solvers without an
/// answer.
std::string DescribeComparison(const std::vector<ComparisonRow>& rows);

}  // namespace sextant
