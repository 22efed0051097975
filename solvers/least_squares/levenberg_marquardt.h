// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace sextant {

/// Marquardt's damping: the share of the diagonal of J^T J that is added to it. A tenth after a
/// step that was taken; ten times as much, and at least `first`, after one that was rejected.
struct Damping {
  double first = 1e-6;
  double max = 1e12;  ///< Above this no step lowers the cost.
};

enum class Trial {
  kTaken,     ///< The cost does not rise; the state, its cost and its derivatives are the new ones.
  kRejected,  ///< The cost rises, or a residual is undefined there; the state is as before.
  kConverged,  ///< The stopping inequality of the problem holds.
};

enum class MinimiserOutcome { kConverged, kMaxSteps, kStalled };

struct MinimiserSummary {
  int steps = 0;  ///< Steps computed, with those that were rejected and the one that ended it.
  MinimiserOutcome outcome = MinimiserOutcome::kMaxSteps;
};

/// argmin of 1/2 sum |r_i|^2 by the method of Levenberg and Marquardt (Marquardt 1963), the one
/// loop of all our minimisers. The problem holds the state, and defines
/// - `bool Solve(double damping)`: the step of (J^T J + damping diag(J^T J)) step = -J^T r at the
///   state; false where there is none;
/// - `Trial Try(double damping)`: evaluates where that step leads, takes it unless the cost rises,
///   and states the stopping inequality.
/// A template, as a virtual call would cost as much as the residuals of a few pixels.
template <class Problem>
MinimiserSummary LevenbergMarquardt(Problem& problem, int max_steps, const Damping& damping = {}) {
  MinimiserSummary summary;
  double share = damping.first;
  while (summary.steps < max_steps) {
    ++summary.steps;
    const Trial trial = problem.Solve(share) ? problem.Try(share) : Trial::kRejected;
    if (trial == Trial::kConverged) {
      summary.outcome = MinimiserOutcome::kConverged;
      break;
    }
    share = trial == Trial::kTaken ? 0.1 * share : std::max(10.0 * share, damping.first);
    if (share > damping.max) {
      summary.outcome = MinimiserOutcome::kStalled;
      break;
    }
  }
  return summary;
}

}  // namespace sextant
