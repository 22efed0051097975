// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_problem.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "solvers/blocks/condensed_cost.h"
#include "solvers/joint/joint_costs.h"

namespace sextant {
namespace {

constexpr double kFullWeight = 1.0;

JointWeights NoWeights(const JointView& view) {
  return {std::vector<double>(view.terms.printed.size(), 0.0),
          std::vector<double>(view.terms.face.size(), 0.0),
          std::vector<double>(view.terms.edges.size(), 0.0), Vector6d::Zero(), 0.0};
}

// The residuals of one sensor depend on one of the two poses in a view's block.
constexpr int kPoseColumns = 6;

template <class Cost, class... Arguments>
ceres::CostFunction* OfCamera(Arguments&&... arguments) {
  return new CondensedCost(std::make_unique<Cost>(std::forward<Arguments>(arguments)...), 0,
                           kPoseColumns);
}

template <class Cost, class... Arguments>
ceres::CostFunction* OfLidar(Arguments&&... arguments) {
  return new CondensedCost(std::make_unique<Cost>(std::forward<Arguments>(arguments)...),
                           kPoseColumns, kPoseColumns);
}

}  // namespace

JointProblem::JointProblem(const JointModel& model, const JointState& start)
    : model_(model), state_(start), boards_(start.boards.size()), problem_(UncheckedProblem()) {
  for (const JointView& view : model.views) weights_.push_back(NoWeights(view));
  StorePose(start.cam_from_lidar, cam_from_lidar_.data());
  for (std::size_t i = 0; i < boards_.size(); ++i) {
    StorePose(start.boards[i].cam_from_board, boards_[i].data());
    StorePose(start.boards[i].lidar_from_board, boards_[i].data() + kPoseNumbers);
  }
  problem_.AddParameterBlock(cam_from_lidar_.data(), kPoseNumbers, new PoseManifold(1));
  AddViews();
  AddShared();
}

void JointProblem::Add(JointRows rows, ceres::CostFunction* cost,
                       const std::vector<double*>& blocks) {
  rows.first = row_count_;
  rows.count = cost->num_residuals();
  row_count_ += rows.count;
  rows_.push_back(rows);
  residuals_.push_back(problem_.AddResidualBlock(cost, nullptr, blocks));
}

void JointProblem::AddViews() {
  auto* manifold = new PoseManifold(2);  // The problem owns it from the first use on.
  for (std::size_t i = 0; i < boards_.size(); ++i) {
    const JointView& view = model_.views[i];
    const JointWeights& weights = weights_[i];
    double* board = boards_[i].data();
    problem_.AddParameterBlock(board, manifold->AmbientSize(), manifold);
    for (std::size_t k = 0; k < view.terms.printed.size(); ++k) {
      std::vector<double*> blocks = {board};
      if (!model_.intrinsics.empty()) blocks.push_back(state_.shared.back().data());
      Add({JointKind::kPrinted, i, k},
          OfCamera<PrintedCost>(model_, view.terms.printed[k], weights.printed[k]), blocks);
    }
    for (std::size_t g = 0; g < view.face.size(); ++g) {
      const FaceGroup& group = view.face[g];
      std::vector<double*> blocks = {board};
      for (const std::size_t k : group.shared) blocks.push_back(state_.shared[k].data());
      Add({JointKind::kFace, i, g}, OfLidar<FaceCost>(view, group, weights.face), blocks);
    }
    if (!view.terms.edges.empty()) {
      std::vector<double*> blocks = {board};
      for (const EdgeShift& by : view.shifts) blocks.push_back(state_.shared[by.shared].data());
      Add({JointKind::kEdges, i}, OfLidar<EdgeCost>(model_, view, weights.edges), blocks);
    }
    Add({JointKind::kLink, i}, new LinkCost(view.lever_m, weights.link),
        {cam_from_lidar_.data(), board});
  }
}

void JointProblem::AddShared() {
  for (std::size_t k = 0; k < model_.shared.size(); ++k) {
    const SharedBlock& block = model_.shared[k];
    const double& weight = block.is_ring ? ring_weight_ : kFullWeight;
    residuals_.push_back(
        problem_.AddResidualBlock(new PriorCost(block, weight), nullptr, state_.shared[k].data()));
  }
}

void JointProblem::SetWeights(const std::vector<JointWeights>& weights, double ring_weight) {
  ring_weight_ = ring_weight;
  // The costs refer to the numbers, which must stay where they are.
  for (std::size_t i = 0; i < weights.size(); ++i) {
    std::ranges::copy(weights[i].printed, weights_[i].printed.begin());
    std::ranges::copy(weights[i].face, weights_[i].face.begin());
    std::ranges::copy(weights[i].edges, weights_[i].edges.begin());
    weights_[i].link = weights[i].link;
    weights_[i].link_factor = weights[i].link_factor;
  }
}

SchurSteps JointProblem::Solve(int max_iterations, double step_tolerance) {
  std::vector<double*> boards;
  for (auto& board : boards_) boards.push_back(board.data());
  std::vector<double*> others = {cam_from_lidar_.data()};
  for (Eigen::VectorXd& block : state_.shared) others.push_back(block.data());
  const SchurSteps steps =
      MinimiseBySchur(problem_, boards, others, {max_iterations, step_tolerance, 1e-15});
  StoreState();
  return steps;
}

void JointProblem::StoreState() {
  state_.cam_from_lidar = PoseIn(cam_from_lidar_.data());
  for (std::size_t i = 0; i < boards_.size(); ++i) {
    state_.boards[i] = {PoseIn(boards_[i].data()), PoseIn(boards_[i].data() + kPoseNumbers)};
  }
}

int JointProblem::ObservedIn(const JointRows& rows) const {
  const JointView& view = model_.views[rows.view];
  const JointWeights& weights = weights_[rows.view];
  const auto is_used = [](double weight) { return weight != 0.0; };
  switch (rows.kind) {
    case JointKind::kPrinted:
      return is_used(weights.printed[rows.part])
                 ? 2 * static_cast<int>(view.terms.printed[rows.part].pixels.size())
                 : 0;
    case JointKind::kFace:
      return static_cast<int>(
          std::ranges::count_if(view.face[rows.part].members,
                                [&](std::size_t member) { return is_used(weights.face[member]); }));
    case JointKind::kEdges:
      return static_cast<int>(std::ranges::count_if(weights.edges, is_used));
    case JointKind::kLink:
      return rows.count;
  }
  return rows.count;
}

JointLinearisation JointProblem::Linearise() {
  JointLinearisation at{.shared = 6,
                        .views = boards_.size(),
                        .residuals = {},
                        .derivative = {},
                        .rows = rows_,
                        .link_factors = {}};
  for (const JointWeights& weights : weights_) at.link_factors.push_back(weights.link_factor);
  for (JointRows& rows : at.rows) rows.observed = ObservedIn(rows);
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = residuals_;
  options.parameter_blocks.push_back(cam_from_lidar_.data());
  for (Eigen::VectorXd& block : state_.shared) {
    options.parameter_blocks.push_back(block.data());
    at.shared += static_cast<int>(block.size());
  }
  for (auto& board : boards_) options.parameter_blocks.push_back(board.data());
  problem_.Evaluate(options, nullptr, &at.residuals, nullptr, &at.derivative);
  return at;
}

}  // namespace sextant
