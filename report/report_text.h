// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "eval/metrics/compare.h"
#include "solvers/core/solver.h"

namespace sextant::cli {

/// An answer with its uncertainty and how well it fits in all.
std::string DescribeAnswer(const SolveReport& report);

/// Everything that `sextant solve` says of one answer: the same, and every residual.
std::string DescribeReport(const CalibrationProblem& problem, const SolverSpec& spec,
                           const SolveReport& report);

/// The table of `sextant compare`, a row a solver, and the reasons of those that did not answer.
std::string DescribeComparison(const std::vector<ComparisonRow>& rows);

}  // namespace sextant::cli
