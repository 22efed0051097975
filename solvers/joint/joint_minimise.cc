// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_minimise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/symmetric.h"
#include "solvers/least_squares/levenberg_marquardt.h"

namespace sextant {
namespace {

// A step that more damping made short is no sign of a minimum.
constexpr double kMaxDampingAtEnd = 1e-2;
// A step under this that raises the cost by no more than this share of it is lost in rounding.
constexpr double kSmallStep = 1e-6;
constexpr double kJointRounding = 1e-12;

struct JointStep {
  Eigen::VectorXd shared;
  std::vector<Vector6d> boards;

  double Size() const {
    double size = shared.size() > 0 ? shared.head<6>().norm() : 0.0;
    for (const Vector6d& board : boards) size = std::max(size, board.norm());
    return size;
  }
  bool IsFinite() const { return shared.allFinite() && std::isfinite(Size()); }
};

using BoardByShared = Eigen::Matrix<double, 6, Eigen::Dynamic>;

// Solves the damped normal equations by the Schur complement: boards first, then what is shared,
// then boards again.
JointStep SolveDamped(const JointSystem& system, double damping) {
  Eigen::MatrixXd shared = system.ss;
  shared.diagonal() *= 1.0 + damping;
  Eigen::VectorXd gradient = system.s;
  const std::size_t count = system.views.size();
  std::vector<BoardByShared> by_shared(count);
  JointStep step;
  step.boards.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const JointViewSystem& view = system.views[i];
    Matrix6d damped = view.bb;
    damped.diagonal() *= 1.0 + damping;
    const Eigen::LLT<Matrix6d> factor(damped);
    if (factor.info() == Eigen::Success) {
      by_shared[i] = factor.solve(view.bs);
      step.boards[i] = factor.solve(view.b);
    } else {
      // No observations, or singular: the board keeps its pose.
      by_shared[i].setZero(6, view.bs.cols());
      step.boards[i].setZero();
    }
    shared.noalias() -= view.bs.transpose() * by_shared[i];
    gradient.noalias() -= view.bs.transpose() * step.boards[i];
  }
  step.shared = -SolveSymmetric(shared, gradient);
  for (std::size_t i = 0; i < count; ++i) {
    step.boards[i] = -step.boards[i] - by_shared[i] * step.shared;
  }
  return step;
}

// The joint problem as LevenbergMarquardt takes it.
struct JointProblem {
  const std::vector<JointView>& views;
  const JointUnknowns& unknowns;
  const JointLosses& losses;
  double step_tolerance;
  JointMinimum& best;
  JointStep step = {};

  bool Solve(double damping) {
    step = SolveDamped(best.system, damping);
    return step.IsFinite();
  }

  // Converged where every pose moves by less than step_tolerance, or the cost is lost in rounding.
  Trial Try(double damping) {
    JointState tried = Moved(best.state, unknowns, step.shared, step.boards);
    std::optional<JointSystem> there = Linearise(views, unknowns, losses, tried);
    const double cost = best.system.cost;
    const bool better = there && there->cost <= cost;
    const bool lost_in_rounding =
        there && !better && step.Size() < kSmallStep && there->cost - cost <= kJointRounding * cost;
    if (better) {
      best.state = std::move(tried);
      best.system = *std::move(there);
    }
    if ((step.Size() < step_tolerance && damping <= kMaxDampingAtEnd) || lost_in_rounding) {
      return Trial::kConverged;
    }
    return better ? Trial::kTaken : Trial::kRejected;
  }
};

}  // namespace

JointMinimum MinimiseJointly(const std::vector<JointView>& views, const JointUnknowns& unknowns,
                             const JointLosses& losses, const JointState& start, int max_iterations,
                             double step_tolerance) {
  JointMinimum best{.state = start, .system = *Linearise(views, unknowns, losses, start)};
  JointProblem problem{views, unknowns, losses, step_tolerance, best};
  const MinimiserSummary summary = LevenbergMarquardt(problem, max_iterations);
  best.iterations = summary.steps;
  best.converged = summary.outcome == MinimiserOutcome::kConverged;
  return best;
}

Eigen::MatrixXd SharedInformation(const JointSystem& system) {
  Eigen::MatrixXd information = system.ss;
  for (const JointViewSystem& view : system.views) {
    information.noalias() -= view.bs.transpose() * PseudoInverse(view.bb) * view.bs;
  }
  return 0.5 * (information + information.transpose());
}

}  // namespace sextant
