// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "eval/experiment/definition/trials.h"

namespace sextant {

/// Trials of the usual sort: a problem with known truth is made from the id and given to every
/// solver, whose answers are measured by PoseMetrics() (the kind's first metrics).
///
/// A solver sees only the kinds of data that it needs, and the true pose as its initial one where
/// it needs one and the problem has none. Solvers whose needs the problem of `sample` cannot meet
/// are left out, so one list of solvers serves conditions with different data. Errors:
/// kMissingData where none is left; what `make` says of the sample.
struct ProblemMaker {
  std::function<Expected<KnownProblem>(const TrialId&)> make;
  PoseLimits limits;
  /// Fills the kind's own metrics beside PoseMetrics(); may be empty.
  std::function<void(const KnownProblem&, const Expected<SolveReport>&, MetricValues)>
      measure_more = {};
};
/// The parameters of PoseLimits, for the set of a kind whose settings derive from it.
template <class Set>
Set& AddPoseLimits(Set& set) {
  return set
      .Real("success_deg", &PoseLimits::success_deg, "deg", 0.0, 180.0,
            "a success is within this of the true rotation")
      .Real("success_mm", &PoseLimits::success_mm, "mm", 0.0, 1e6,
            "a success is within this of the true translation")
      .Real("gross_deg", &PoseLimits::gross_deg, "deg", 0.0, 180.0,
            "a pose that is farther off is another pose, not noise");
}

Expected<TrialsPtr> MakeProblemTrials(ProblemMaker maker, std::vector<SolverPtr> solvers);

}  // namespace sextant
