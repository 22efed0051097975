// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/view_comparison.h"

#include "solvers/joint/joint_search.h"
#include "solvers/joint/joint_start.h"

namespace sextant {

Expected<std::vector<ViewComparison>> CompareViews(const CalibrationProblem& problem,
                                                   const Rigid3d& start) {
  const JointOptions options;
  SEXTANT_ASSIGN_OR_RETURN(const JointModel model, ModelOf(problem, options));
  SEXTANT_ASSIGN_OR_RETURN(const JointAnswer answer,
                           SearchJointly(model, StartAt(problem, model, start),
                                         problem.lidar_errors.view_shift_sigma_m, options));
  std::vector<ViewComparison> views;
  for (std::size_t i = 0; i < problem.board_views.size(); ++i) {
    views.push_back(
        {problem.board_views[i].view, answer.selection[i].IsUsed(), answer.disagreement[i]});
  }
  return views;
}

}  // namespace sextant
