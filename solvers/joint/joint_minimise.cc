// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_minimise.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

// Of the share of the diagonal that is added to it.
constexpr double kFirstDamping = 1e-6;
constexpr double kMaxDamping = 1e12;
// A step that more of it made short is no sign of a minimum.
constexpr double kMaxDampingAtEnd = 1e-2;
// Steps under this that raise the cost by no more than this share of it.
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

// Solves the damped normal equations: boards first, then what is shared, then boards again.
JointStep Solve(const JointSystem& system, double damping) {
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
      // Left out, or not determined: the board stays where it is.
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

}  // namespace

JointMinimum MinimiseJointly(const std::vector<JointView>& views, const JointUnknowns& unknowns,
                             const JointLosses& losses, const JointState& start, int max_iterations,
                             double step_tolerance) {
  JointMinimum best;
  best.state = start;
  best.system = *Linearise(views, unknowns, losses, start);
  double damping = kFirstDamping;
  while (best.iterations < max_iterations && damping < kMaxDamping) {
    ++best.iterations;
    const JointStep step = Solve(best.system, damping);
    if (!step.IsFinite()) {
      damping *= 10.0;
      continue;
    }
    JointState tried = Moved(best.state, unknowns, step.shared, step.boards);
    std::optional<JointSystem> there = Linearise(views, unknowns, losses, tried);
    const bool better = there && there->cost <= best.system.cost;
    const double rise = there ? there->cost - best.system.cost : best.system.cost;
    if (better) {
      best.state = std::move(tried);
      best.system = *std::move(there);
    }
    const bool lost_in_rounding =
        !better && step.Size() < kSmallStep && rise <= kJointRounding * best.system.cost;
    best.converged =
        (step.Size() < step_tolerance && damping <= kMaxDampingAtEnd) || lost_in_rounding;
    if (best.converged) break;
    damping *= better ? 0.1 : 10.0;
  }
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
