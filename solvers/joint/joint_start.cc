// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_start.h"

#include <cmath>

namespace sextant {
namespace {

// Cauchy's loss of a squared residual, as it limits what an outlier costs.
double Limited(double squared) {
  constexpr double kScale = 3.0;
  return kScale * kScale * std::log1p(squared / (kScale * kScale));
}

// The cost of a view's printed points.
double CostAt(const JointModel& model, const JointState& state, std::size_t view) {
  double cost = 0.0;
  for (const double value : ResidualsAt(model, state, view).printed) cost += Limited(value * value);
  return cost;
}

double LinkCostAt(const JointState& state, std::size_t view, double lever_m) {
  constexpr double kUsual_m = 0.02;
  return Limited((LinkError(state, view, lever_m) / kUsual_m).squaredNorm() / 6.0);
}

}  // namespace

JointState StartAt(const CalibrationProblem& problem, const JointModel& model,
                   const Rigid3d& cam_from_lidar) {
  JointState state{cam_from_lidar, {}, {}};
  for (const SharedBlock& block : model.shared) state.shared.push_back(block.mean);
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    const BoardView& view = problem.board_views[i];
    const Rigid3d by_lidar = cam_from_lidar * view.lidar_from_board;
    state.boards.push_back({view.cam_from_board, view.lidar_from_board});
    const double by_camera_cost =
        CostAt(model, state, i) + LinkCostAt(state, i, model.views[i].lever_m);
    state.boards.back().cam_from_board = by_lidar;
    if (by_camera_cost <= CostAt(model, state, i)) {
      state.boards.back().cam_from_board = view.cam_from_board;
    }
  }
  return state;
}

}  // namespace sextant
