// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_minimum.h"

#include <ceres/sized_cost_function.h>

#include <algorithm>
#include <map>

#include "solvers/rig/rig_costs.h"

namespace sextant {
namespace {

/// number / sigma.
class NumberPrior final : public ceres::SizedCostFunction<1, 1> {
 public:
  explicit NumberPrior(double sigma) : sigma_(sigma) {}
  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    residuals[0] = parameters[0][0] / sigma_;
    if (jacobians != nullptr && jacobians[0] != nullptr) jacobians[0][0] = 1.0 / sigma_;
    return true;
  }

 private:
  double sigma_;
};

}  // namespace

RigMinimum::RigMinimum(const RigModel& model, std::size_t root, const RigState& start)
    : model_(model), root_(root), problem_(UncheckedProblem()) {
  for (const RigBlock& block : model.blocks) {
    weights_.blocks.emplace_back(static_cast<std::size_t>(block.units), 0.0);
  }
  for (const RigPlacementModel& placement : model.placements) {
    weights_.shifts_by_m.emplace_back(placement.shifts.size(), Vector6d::Zero());
    placements_.emplace_back(static_cast<std::size_t>(kPoseNumbers * placement.poses()));
  }
  sensors_.resize(model.sensors);
  Load(start);
  auto* manifold = new PoseManifold(1);  // The problem owns it from the first use on.
  for (auto& sensor : sensors_) problem_.AddParameterBlock(sensor.data(), kPoseNumbers, manifold);
  problem_.SetParameterBlockConstant(sensors_[root].data());
  std::map<std::size_t, ceres::Manifold*> by_poses;
  std::size_t block = 0;
  for (std::size_t i = 0; i < placements_.size(); ++i) {
    const std::size_t poses = placements_[i].size() / kPoseNumbers;
    ceres::Manifold*& shared = by_poses[poses];
    if (shared == nullptr) shared = new PoseManifold(static_cast<int>(poses));
    problem_.AddParameterBlock(placements_[i].data(), static_cast<int>(placements_[i].size()),
                               shared);
    for (; block < model.blocks.size() && model.blocks[block].placement == i; ++block) {
      AddBlock(block);
    }
    AddShifts(i);
    if (model.placements[i].moves) AddMotion(i);
  }
  AddNumbers();
}

void RigMinimum::AddBlock(std::size_t index) {
  const RigBlock& block = model_.blocks[index];
  std::vector<double*> parameters = {sensors_[block.sensor].data(),
                                     placements_[block.placement].data()};
  for (const RigNumberUse& use : block.numbers) {
    parameters.push_back(&state_.numbers[use.number]);
  }
  if (block.clock) parameters.push_back(&state_.numbers[*block.clock]);
  auto* cost = new RigBlockCost(block, model_.placements[block.placement], weights_.blocks[index]);
  residuals_.push_back(problem_.AddResidualBlock(cost, nullptr, parameters));
  rows_.push_back({.placement = block.placement,
                   .sensor = block.sensor,
                   .block = static_cast<int>(index),
                   .first = row_count_,
                   .count = block.rows()});
  row_count_ += block.rows();
}

void RigMinimum::AddShifts(std::size_t placement) {
  const RigPlacementModel& model = model_.placements[placement];
  for (std::size_t s = 0; s < model.shifts.size(); ++s) {
    auto* cost = new ShiftCost(model, s, weights_.shifts_by_m[placement][s]);
    residuals_.push_back(problem_.AddResidualBlock(cost, nullptr, placements_[placement].data()));
    rows_.push_back({.placement = placement,
                     .sensor = model.shifts[s].sensor,
                     .block = kShiftRows,
                     .first = row_count_,
                     .count = 6});
    row_count_ += 6;
  }
}

void RigMinimum::AddMotion(std::size_t placement) {
  auto* cost = new MotionCost(model_.placements[placement]);
  residuals_.push_back(problem_.AddResidualBlock(cost, nullptr, placements_[placement].data()));
  rows_.push_back({.placement = placement, .block = kMotionRows, .first = row_count_, .count = 12});
  row_count_ += 12;
}

void RigMinimum::AddNumbers() {
  for (std::size_t k = 0; k < model_.numbers.size(); ++k) {
    residuals_.push_back(problem_.AddResidualBlock(new NumberPrior(model_.numbers[k].sigma),
                                                   nullptr, &state_.numbers[k]));
  }
}

void RigMinimum::Load(const RigState& state) {
  state_ = state;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    StorePose(state.sensor_from_root[s], sensors_[s].data());
  }
  for (std::size_t i = 0; i < placements_.size(); ++i) {
    StorePose(state.root_from_board[i], placements_[i].data());
    for (std::size_t s = 0; s < state.shifts[i].size(); ++s) {
      StorePose(state.shifts[i][s], placements_[i].data() + kPoseNumbers * (1 + s));
    }
    if (!model_.placements[i].moves) continue;
    double* motion = placements_[i].data() + kPoseNumbers * model_.placements[i].first_of_motion();
    for (std::size_t k = 0; k < 2; ++k) StorePose(state.motions[i][k], motion + kPoseNumbers * k);
  }
}

void RigMinimum::Store() {
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    state_.sensor_from_root[s] = PoseIn(sensors_[s].data());
  }
  for (std::size_t i = 0; i < placements_.size(); ++i) {
    state_.root_from_board[i] = PoseIn(placements_[i].data());
    for (std::size_t s = 0; s < state_.shifts[i].size(); ++s) {
      state_.shifts[i][s] = PoseIn(placements_[i].data() + kPoseNumbers * (1 + s));
    }
    if (!model_.placements[i].moves) continue;
    const double* motion =
        placements_[i].data() + kPoseNumbers * model_.placements[i].first_of_motion();
    for (std::size_t k = 0; k < 2; ++k) state_.motions[i][k] = PoseIn(motion + kPoseNumbers * k);
  }
}

void RigMinimum::SetWeights(const RigWeights& weights) {
  // The costs refer to the numbers, which must stay where they are.
  for (std::size_t i = 0; i < weights.blocks.size(); ++i) {
    std::ranges::copy(weights.blocks[i], weights_.blocks[i].begin());
  }
  for (std::size_t i = 0; i < weights.shifts_by_m.size(); ++i) {
    std::ranges::copy(weights.shifts_by_m[i], weights_.shifts_by_m[i].begin());
  }
}

SchurSteps RigMinimum::Solve(int max_iterations, double step_tolerance) {
  std::vector<double*> placements;
  for (auto& placement : placements_) placements.push_back(placement.data());
  std::vector<double*> others;
  for (auto& sensor : sensors_) others.push_back(sensor.data());
  for (double& number : state_.numbers) others.push_back(&number);
  const SchurSteps steps =
      MinimiseBySchur(problem_, placements, others, {max_iterations, step_tolerance, 1e-12});
  Store();
  return steps;
}

RigLinearisation RigMinimum::Linearise() {
  RigLinearisation at;
  at.rows = rows_;
  ceres::Problem::EvaluateOptions options;
  options.residual_blocks = residuals_;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    if (s == root_) continue;
    options.parameter_blocks.push_back(sensors_[s].data());
    at.shared += 6;
  }
  for (double& number : state_.numbers) {
    options.parameter_blocks.push_back(&number);
    ++at.shared;
  }
  int column = at.shared;
  for (auto& placement : placements_) {
    options.parameter_blocks.push_back(placement.data());
    at.first_column.push_back(column);
    column += 6 * static_cast<int>(placement.size() / kPoseNumbers);
  }
  at.first_column.push_back(column);
  problem_.Evaluate(options, nullptr, &at.residuals, nullptr, &at.derivative);
  return at;
}

}  // namespace sextant
