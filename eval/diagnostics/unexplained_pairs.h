// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// The RMS residual of the pairs that an answer uses, over the RMS distance of their camera points,
/// or pixels, from their mean [-]: about 0 for correspondences, near 1 for unrelated points. Pixels
/// that spread over more than a fifth of the focal length (11 deg) count as if they spread over
/// that, because a wide image makes no corner less certain, and their residual is that of noise
/// which leaves as much after six unknowns. None for problems with both kinds of pairs or without
/// pairs, and for fewer than four used ones. O(n).
std::optional<double> UnexplainedShare(const CalibrationProblem& problem,
                                       const SolveReport& report);

/// A larger share explains nothing: measurements of boards are at a tenth even where the noise is
/// large.
inline constexpr double kMaxUnexplainedShare = 0.3;

/// A sentence where the answer to pairs that state no noise leaves more than a fifth of their
/// spread: more than measurements usually do, but less than kMaxUnexplainedShare may be.
std::optional<std::string> DescribeMisfit(const CalibrationProblem& problem,
                                          const SolveReport& report);

}  // namespace sextant
