// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_costs.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/uncertain_pose.h"
#include "solvers/blocks/derivative_block.h"
#include "solvers/blocks/log_by_turn.h"
#include "solvers/blocks/pose_manifold.h"

namespace sextant {

RigBlockCost::RigBlockCost(const RigBlock& block, const RigPlacementModel& placement,
                           const std::vector<double>& weights)
    : block_(block),
      shift_(placement.shift_of[block.seen]),
      poses_(placement.poses()),
      motion_(placement.moves ? placement.first_of_motion() : -1),
      weights_(weights) {
  // Only returns are shifted: other kinds state all of their error.
  if (block.kind != RigKind::kFace && block.kind != RigKind::kEdges) shift_ = -1;
  set_num_residuals(block.rows());
  mutable_parameter_block_sizes()->push_back(kPoseNumbers);
  mutable_parameter_block_sizes()->push_back(kPoseNumbers * poses_);
  mutable_parameter_block_sizes()->insert(mutable_parameter_block_sizes()->end(),
                                          block.numbers.size() + (block.clock ? 1 : 0), 1);
}

// Nothing of the block is used, as where its residuals cannot be evaluated at the start.
void RigBlockCost::SetZero(double* residuals, double** jacobians) const {
  std::fill_n(residuals, num_residuals(), 0.0);
  for (std::size_t k = 0; jacobians != nullptr && k < parameter_block_sizes().size(); ++k) {
    ZeroDerivative(jacobians, k, num_residuals(), parameter_block_sizes()[k]);
  }
}

bool RigBlockCost::Evaluate(double const* const* parameters, double* residuals,
                            double** jacobians) const {
  if (std::ranges::all_of(weights_, [](double weight) { return weight == 0.0; })) {
    SetZero(residuals, jacobians);
    return true;
  }
  const Rigid3d sensor_from_root = PoseIn(parameters[0]);
  const Rigid3d root_from_board = PoseIn(parameters[1]);
  const int shift_at = shift_ < 0 ? 0 : 1 + shift_;
  const Rigid3d board_from_seen =
      shift_ < 0 ? Rigid3d{} : PoseIn(parameters[1] + kPoseNumbers * shift_at);
  const std::size_t clock = 2 + block_.numbers.size();
  MovedBoard moved;
  if (motion_ >= 0) {
    const double* motion = parameters[1] + kPoseNumbers * motion_;
    const double time_s = block_.time_s - (block_.clock ? *parameters[clock] : 0.0);
    moved = MovedAfter({PoseIn(motion), PoseIn(motion + kPoseNumbers)}, time_s);
  }
  const Rigid3d board_from_moved_seen = moved.board_from_moved * board_from_seen;
  const Rigid3d root_from_seen = root_from_board * board_from_moved_seen;
  RigResiduals at;
  if (!block_.residuals(sensor_from_root * root_from_seen, at)) return false;
  for (std::size_t k = 0; k < block_.numbers.size(); ++k) {
    at.value += *parameters[2 + k] * block_.numbers[k].by;
  }
  Eigen::VectorXd weights(block_.rows());
  for (int i = 0; i < block_.rows(); ++i) {
    weights[i] = weights_[static_cast<std::size_t>(i / block_.rows_per_unit)];
  }
  Eigen::Map<Eigen::VectorXd>(residuals, block_.rows()) = weights.cwiseProduct(at.value);
  if (jacobians == nullptr) return true;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose = weights.asDiagonal() * at.by_pose;
  const ProductJacobians outer = JacobiansOfProduct(sensor_from_root, root_from_seen);
  auto by_sensor = ZeroDerivative(jacobians, 0, block_.rows(), kPoseNumbers);
  if (by_sensor.size() > 0) by_sensor.leftCols<6>() = by_pose * outer.by_left;
  const ProductJacobians inner = JacobiansOfProduct(root_from_board, board_from_moved_seen);
  const ProductJacobians within = JacobiansOfProduct(moved.board_from_moved, board_from_seen);
  const Eigen::Matrix<double, Eigen::Dynamic, 6> by_root = by_pose * outer.by_right;
  const Eigen::Matrix<double, Eigen::Dynamic, 6> by_moved_seen = by_root * inner.by_right;
  auto by_placement = ZeroDerivative(jacobians, 1, block_.rows(), kPoseNumbers * poses_);
  if (by_placement.size() > 0) {
    by_placement.leftCols<6>() = by_root * inner.by_left;
    if (shift_ >= 0) by_placement.middleCols<6>(6 * shift_at) = by_moved_seen * within.by_right;
    for (int k = 0; k < 2 && motion_ >= 0; ++k) {
      by_placement.middleCols<6>(6 * (motion_ + k)) =
          by_moved_seen * within.by_left * moved.by_motion[static_cast<std::size_t>(k)];
    }
  }
  if (block_.clock) {
    auto by_clock = ZeroDerivative(jacobians, clock, block_.rows(), 1);
    if (by_clock.size() > 0) by_clock.col(0) = -by_moved_seen * within.by_left * moved.by_time;
  }
  for (std::size_t k = 0; k < block_.numbers.size(); ++k) {
    auto by_number = ZeroDerivative(jacobians, 2 + k, block_.rows(), 1);
    if (by_number.size() > 0) by_number.col(0) = weights.cwiseProduct(block_.numbers[k].by);
  }
  return true;
}

ShiftCost::ShiftCost(const RigPlacementModel& placement, std::size_t shift,
                     const Vector6d& weights_by_m)
    : shift_(shift),
      lever_m_(placement.shifts[shift].lever_m),
      poses_(placement.poses()),
      weights_by_m_(weights_by_m) {
  set_num_residuals(6);
  mutable_parameter_block_sizes()->push_back(kPoseNumbers * poses_);
}

bool ShiftCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const int at = 1 + static_cast<int>(shift_);
  const Rigid3d shift = PoseIn(parameters[0] + kPoseNumbers * at);
  const Eigen::Vector3d turn = LogSo3(shift.rotation);
  Vector6d values;
  values << lever_m_ * turn, shift.translation;
  Eigen::Map<Vector6d>(residuals, 6) = weights_by_m_.cwiseProduct(values);
  auto by = ZeroDerivative(jacobians, 0, 6, kPoseNumbers * poses_);
  if (by.size() == 0) return true;
  Matrix6d by_shift = Matrix6d::Identity();
  by_shift.topLeftCorner<3, 3>() = lever_m_ * LogByTurn(turn);
  by.middleCols<6>(6 * at) = weights_by_m_.asDiagonal() * by_shift;
  return true;
}

MotionCost::MotionCost(const RigPlacementModel& placement)
    : first_(placement.first_of_motion()), poses_(placement.poses()) {
  set_num_residuals(12);
  mutable_parameter_block_sizes()->push_back(kPoseNumbers * poses_);
}

bool MotionCost::Evaluate(double const* const* parameters, double* residuals,
                          double** jacobians) const {
  auto by = ZeroDerivative(jacobians, 0, 12, kPoseNumbers * poses_);
  for (int k = 0; k < 2; ++k) {
    const Rigid3d step = PoseIn(parameters[0] + kPoseNumbers * (first_ + k));
    const MotionSigma& sigma = kMotionSigmas[static_cast<std::size_t>(k)];
    const Eigen::Vector3d turn = LogSo3(step.rotation);
    Eigen::Map<Vector6d> of(residuals + 6 * k);
    of << turn / sigma.turn_rad, step.translation / sigma.shift_m;
    if (by.size() == 0) continue;
    const int column = 6 * (first_ + k);
    by.block<3, 3>(6 * k, column) = LogByTurn(turn) / sigma.turn_rad;
    by.block<3, 3>(6 * k + 3, column + 3) = Eigen::Matrix3d::Identity() / sigma.shift_m;
  }
  return true;
}

}  // namespace sextant
