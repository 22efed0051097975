// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <utility>

#include "solvers/least_squares/levenberg_marquardt.h"
#include "solvers/least_squares/normal_step.h"

namespace sextant {

struct RefineLimits {
  int max_iterations = 50;
  double step_tolerance = 1e-10;  ///< Largest last step: |dphi| [rad], |dt| / (1 + |t|) [m].
  /// Evaluates the information at the answer itself, which costs a pass over the terms.
  bool wants_information = true;
};

enum class RefineOutcome {
  kConverged,      ///< The next step is under the tolerance.
  kMaxIterations,  ///< Stopped by the limit.
  kStalled,        ///< No damping made the cost fall.
  kNotProjected,   ///< A point does not project at the start.
};

template <class Equations>
struct PoseMinimum {
  Rigid3d pose;
  Equations equations;  ///< There, or within 1e-6 rad and m without wants_information.
  int iterations = 1;   ///< Times the residuals were differentiated.
  RefineOutcome outcome = RefineOutcome::kMaxIterations;
};

/// A pose and its normal equations as LevenbergMarquardt takes them; see MinimisePose.
template <class Equations, class Evaluate>
class PoseProblem {
 public:
  PoseProblem(const Evaluate& evaluate, const RefineLimits& limits, PoseMinimum<Equations>& best)
      : evaluate_(evaluate), limits_(limits), best_(best) {}

  bool Solve(double damping) {
    step_ = DampedStep(best_.equations.information, best_.equations.gradient, damping);
    return step_.has_value();
  }

  Trial Try(double /*damping*/) {
    const double size = SizeOf(*step_, best_.pose);
    if (size < kLastStep && size * size <= limits_.step_tolerance * last_size_) {
      TakeLast();
      return Trial::kConverged;
    }
    if (size <= limits_.step_tolerance) return Trial::kConverged;
    const Rigid3d next = Moved(best_.pose, *step_);
    const bool falls = step_->allFinite() && evaluate_(next, there_) &&
                       there_.squares <= (1.0 + kCostRounding) * best_.equations.squares;
    last_size_ = falls ? size : 0.0;
    if (!falls) return Trial::kRejected;
    best_.pose = next;
    std::swap(best_.equations, there_);
    return Trial::kTaken;
  }

 private:
  // What a smaller step changes of J^T J does not matter: it may be the last, untested.
  static constexpr double kLastStep = 1e-6;
  // The cost is a sum of many rounded terms: a rise of this share is no rise.
  static constexpr double kCostRounding = 1e-14;

  void TakeLast() {
    best_.pose = Moved(best_.pose, *step_);
    best_.equations.squares += best_.equations.gradient.dot(*step_);
    if (limits_.wants_information && evaluate_(best_.pose, there_)) best_.equations = there_;
  }

  const Evaluate& evaluate_;
  const RefineLimits& limits_;
  PoseMinimum<Equations>& best_;
  std::optional<Vector6d> step_;
  Equations there_;
  double last_size_ = 0.0;  // Size of the last step, 0 if it was rejected.
};

/// argmin over SE(3) of the squared residuals' sum near `start`, on the 6 numbers of Perturb.
/// `evaluate(pose, equations)` fills `information` J^T J, `gradient` J^T r and `squares` r^T r;
/// false where a residual is undefined. Ends where a step is under the tolerance, or with the step
/// after which, as steps shrink at least as fast as the last two did, the next would be:
/// size^2 <= step_tolerance * last size.
template <class Equations, class Evaluate>
PoseMinimum<Equations> MinimisePose(const Evaluate& evaluate, const Rigid3d& start,
                                    const RefineLimits& limits) {
  PoseMinimum<Equations> best;
  best.pose = start;
  if (!evaluate(start, best.equations)) {
    best.outcome = RefineOutcome::kNotProjected;
    return best;
  }
  PoseProblem<Equations, Evaluate> problem(evaluate, limits, best);
  const MinimiserSummary summary = LevenbergMarquardt(problem, limits.max_iterations - 1);
  best.iterations += summary.steps;
  if (summary.outcome == MinimiserOutcome::kConverged) {
    --best.iterations;
    best.outcome = RefineOutcome::kConverged;
  } else if (summary.outcome == MinimiserOutcome::kStalled) {
    best.outcome = RefineOutcome::kStalled;
  }
  return best;
}

}  // namespace sextant
