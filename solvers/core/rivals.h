// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"

namespace sextant {

/// A set of pairs rivals that of the answer from this share of its size on.
inline constexpr double kRivalShare = 0.8;

/// The pose of a second consensus: where a solver left pairs out, a pose that nearly as many of
/// these agree on (kRivalShare), within twice the largest residual of the answer's own pairs, and
/// that most of the answer's pairs contradict. Two boards of which one is listed in a wrong order
/// give two such sets, and the data does not determine which is right. It must gather more pairs
/// than chance explains (under 0.01 such poses expected), and is least squares on them.
///
/// Random samples of three of the pairs left out; at most 64, so that rivals are found only where
/// they would be about half of these: among many outliers a second consensus is no rival. Empty
/// where the answer uses all pairs, and for solvers of other data than one kind of pairs. `answer`
/// has been evaluated. Cost: for random outliers a few residuals of each sampled pose.
std::vector<Rigid3d> FindRivals(const CalibrationProblem& problem, const SolverSpec& spec,
                                const SolveReport& answer);

}  // namespace sextant
