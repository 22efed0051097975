// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "eval/experiment/definition/trials.h"

namespace sextant {

/// How a kind makes its problems. In each trial a problem with known truth is made from the trial's
/// id and given to every solver, and the results are measured by PoseMetrics() (the kind's first
/// metrics).
///
/// A solver gets only the kinds of data that it needs, and the true pose as its initial pose if it
/// needs one and the problem has none.
struct ProblemMaker {
  std::function<Expected<KnownProblem>(const TrialId&)> make;
  PoseLimits limits;
  /// Sets the kind's own metrics after PoseMetrics(); may be empty.
  std::function<void(const KnownProblem&, const Expected<SolveReport>&, MetricValues)>
      measure_more = {};
};
/// Adds the parameters of PoseLimits to the set of a kind whose settings derive from it.
template <class Set>
Set& AddPoseLimits(Set& set) {
  return set
      .Real("success_deg", &PoseLimits::success_deg, "deg", 0.0, 180.0,
            "maximum rotation error of a success")
      .Real("success_mm", &PoseLimits::success_mm, "mm", 0.0, 1e6,
            "maximum translation error of a success")
      .Real("gross_deg", &PoseLimits::gross_deg, "deg", 0.0, 180.0,
            "a larger rotation error is gross, not noise");
}

/// Makes the trials. Solvers that cannot use the data of a sample problem are left out, so one list
/// of solvers serves conditions with different data. `condition`: the name by which imported poses
/// are found. Errors: kMissingData if no solver is left; those of `make` for the sample.
Expected<TrialsPtr> MakeProblemTrials(ProblemMaker maker, std::vector<SolverPtr> solvers,
                                      const std::string& condition);

}  // namespace sextant
