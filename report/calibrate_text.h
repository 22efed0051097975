// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "io/results/calibration_result.h"
#include "solvers/core/solver.h"

namespace sextant::cli {

/// What became of each board of each view, a row each; with residuals where there is an answer, and
/// how far the view is off the answer of the others where `judged` says it.
std::string DescribeViews(const std::vector<SessionView>& views, const Assembly& assembly,
                          const SolveReport* report, const std::vector<ResultView>& judged);

/// The text in lines of at most `width` characters, broken at blanks.
std::string Wrapped(const std::string& text, std::size_t width);

}  // namespace sextant::cli
