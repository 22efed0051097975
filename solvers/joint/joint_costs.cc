// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_costs.h"

#include <Eigen/Geometry>

#include "geometry/intrinsics.h"
#include "solvers/blocks/derivative_block.h"
#include "solvers/blocks/log_by_turn.h"
#include "solvers/blocks/pose_manifold.h"

namespace sextant {
namespace {

constexpr int kViewNumbers = 2 * kPoseNumbers;
// Columns of the pose in the LiDAR within the derivative by a view's block.
constexpr int kLidarColumns = 6;

}  // namespace

PrintedCost::PrintedCost(const JointModel& model, const PrintedTerm& term, const double& weight)
    : model_(model), term_(term), weight_(weight) {
  set_num_residuals(2 * static_cast<int>(term.pixels.size()));
  mutable_parameter_block_sizes()->push_back(kViewNumbers);
  if (!model.intrinsics.empty()) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(model.intrinsics.size()));
  }
}

bool PrintedCost::Evaluate(double const* const* parameters, double* residuals,
                           double** jacobians) const {
  Eigen::Map<Eigen::VectorXd> values(residuals, num_residuals());
  DerivativeBlock by_view = ZeroDerivative(jacobians, 0, num_residuals(), kViewNumbers);
  const auto free = static_cast<Eigen::Index>(model_.intrinsics.size());
  const bool by_camera = free > 0 && jacobians != nullptr && jacobians[1] != nullptr;
  if (by_camera) ZeroDerivative(jacobians, 1, num_residuals(), free);
  values.setZero();
  if (weight_ == 0.0) return true;
  const Camera camera =
      free > 0 ? model_.CameraWith(Eigen::Map<const Eigen::VectorXd>(parameters[1], free))
               : model_.camera;
  if (!(camera.fx_px > 0.0 && camera.fy_px > 0.0)) return false;
  PrintedResidual at;
  if (!Differentiate(term_, camera, PoseIn(parameters[0]), at)) return false;
  values = weight_ * at.value;
  if (by_view.size() > 0) by_view.leftCols<6>() = weight_ * at.by_pose;
  return !by_camera || Differentiated(camera, at, jacobians[1]);
}

bool PrintedCost::Differentiated(const Camera& camera, const PrintedResidual& at,
                                 double* jacobian) const {
  DerivativeBlock by(jacobian, num_residuals(), std::ssize(model_.intrinsics));
  for (std::size_t i = 0; i < at.in_cam.size(); ++i) {
    const auto pixel_by = PixelByIntrinsics(camera, at.in_cam[i]);
    if (!pixel_by) return false;
    for (Eigen::Index k = 0; k < by.cols(); ++k) {
      by.block<2, 1>(2 * static_cast<Eigen::Index>(i), k) =
          -pixel_by->col(model_.intrinsics[static_cast<std::size_t>(k)]);
    }
  }
  by = (term_.whitener.triangularView<Eigen::Lower>() * by).eval();
  by *= weight_;
  return true;
}

FaceCost::FaceCost(const JointView& view, const FaceGroup& group,
                   const std::vector<double>& weights)
    : view_(view), group_(group), weights_(weights) {
  set_num_residuals(static_cast<int>(group.members.size()));
  mutable_parameter_block_sizes()->push_back(kViewNumbers);
  mutable_parameter_block_sizes()->insert(mutable_parameter_block_sizes()->end(),
                                          group.shared.size(), 1);
}

bool FaceCost::Evaluate(double const* const* parameters, double* residuals,
                        double** jacobians) const {
  const BoardPlane plane(PoseIn(parameters[0] + kPoseNumbers));
  DerivativeBlock by_view = ZeroDerivative(jacobians, 0, num_residuals(), kViewNumbers);
  Eigen::VectorXd offset = Eigen::VectorXd::Zero(num_residuals());
  for (Eigen::Index k = 0; k < group_.by.cols(); ++k) {
    offset += group_.by.col(k) * *parameters[k + 1];
  }
  RayResidual ray;
  for (int i = 0; i < num_residuals(); ++i) {
    const std::size_t member = group_.members[static_cast<std::size_t>(i)];
    const FaceTerm& term = view_.terms.face[member];
    const double weight = weights_[member];
    residuals[i] = 0.0;
    if (weight != 0.0) {
      if (!Differentiate(term, plane, ray)) return false;
      residuals[i] = weight * (ray.value - term.inverse_sigma * offset[i]);
      if (by_view.size() > 0) by_view.block<1, 6>(i, kLidarColumns) = weight * ray.by_pose;
    }
    for (Eigen::Index k = 0; jacobians != nullptr && k < group_.by.cols(); ++k) {
      if (jacobians[k + 1] == nullptr) continue;
      jacobians[k + 1][i] = -weight * term.inverse_sigma * group_.by(i, k);
    }
  }
  return true;
}

EdgeCost::EdgeCost(const JointModel& model, const JointView& view,
                   const std::vector<double>& weights)
    : model_(model), view_(view), weights_(weights) {
  set_num_residuals(static_cast<int>(view.terms.edges.size()));
  mutable_parameter_block_sizes()->push_back(kViewNumbers);
  for (const EdgeShift& shift : view.shifts) {
    mutable_parameter_block_sizes()->push_back(static_cast<int>(shift.by.cols()));
  }
}

bool EdgeCost::Evaluate(double const* const* parameters, double* residuals,
                        double** jacobians) const {
  const BoardPlane plane(PoseIn(parameters[0] + kPoseNumbers));
  DerivativeBlock by_view = ZeroDerivative(jacobians, 0, num_residuals(), kViewNumbers);
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(num_residuals());
  Eigen::VectorXd factor(num_residuals());
  for (std::size_t s = 0; s < view_.shifts.size(); ++s) {
    const EdgeShift& by = view_.shifts[s];
    const Eigen::Map<const Eigen::VectorXd> numbers(parameters[s + 1], by.by.cols());
    shift += by.by * (numbers - model_.shared[by.shared].mean);
  }
  RayResidual ray;
  for (int i = 0; i < num_residuals(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const EdgeTerm& term = view_.terms.edges[k];
    factor[i] = weights_[k] * term.inverse_sigma;
    residuals[i] = 0.0;
    if (weights_[k] == 0.0) continue;
    if (!Differentiate(term, plane, ray)) return false;
    residuals[i] = weights_[k] * ray.value + factor[i] * shift[i];
    if (by_view.size() > 0) by_view.block<1, 6>(i, kLidarColumns) = weights_[k] * ray.by_pose;
  }
  for (std::size_t s = 0; s < view_.shifts.size(); ++s) {
    DerivativeBlock by =
        ZeroDerivative(jacobians, s + 1, num_residuals(), view_.shifts[s].by.cols());
    if (by.size() > 0) by = factor.asDiagonal() * view_.shifts[s].by;
  }
  return true;
}

// With E = board_from_cam cam_from_lidar lidar_from_board, C and R the rotations of cam_from_board
// and cam_from_lidar: dlog(E) = J^-1 C^T (dphi - dphi_cam + R dphi_lidar), and the translation
// C^T (R t_lidar + t - t_cam) is differentiated term by term.
bool LinkCost::Evaluate(double const* const* parameters, double* residuals,
                        double** jacobians) const {
  const Rigid3d cam_from_lidar = PoseIn(parameters[0]);
  const Rigid3d cam_from_board = PoseIn(parameters[1]);
  const Rigid3d lidar_from_board = PoseIn(parameters[1] + kPoseNumbers);
  const Rigid3d error = cam_from_board.Inverse() * cam_from_lidar * lidar_from_board;
  const Eigen::Vector3d turn = LogSo3(error.rotation);
  Eigen::Map<Vector6d> values(residuals);
  values << lever_m_ * turn, error.translation;
  values = scale_.cwiseProduct(values).eval();
  DerivativeBlock by_pose = ZeroDerivative(jacobians, 0, 6, kPoseNumbers);
  DerivativeBlock by_view = ZeroDerivative(jacobians, 1, 6, kViewNumbers);
  if (by_pose.size() == 0 && by_view.size() == 0) return true;
  const Eigen::Matrix3d turned = cam_from_lidar.rotation.toRotationMatrix();
  const Eigen::Matrix3d back = cam_from_board.rotation.conjugate().toRotationMatrix();
  const Eigen::Matrix3d by_turn = lever_m_ * LogByTurn(turn) * back;
  const Eigen::Vector3d arm = turned * lidar_from_board.translation;
  const Eigen::Vector3d off = arm + cam_from_lidar.translation - cam_from_board.translation;
  if (by_pose.size() > 0) {
    by_pose.block<3, 3>(0, 0) = by_turn;
    by_pose.block<3, 3>(3, 0) = -back * Hat(arm);
    by_pose.block<3, 3>(3, 3) = back;
    by_pose = (scale_.asDiagonal() * by_pose).eval();
  }
  if (by_view.size() > 0) {
    by_view.block<3, 3>(0, 0) = -by_turn;
    by_view.block<3, 3>(3, 0) = back * Hat(off);
    by_view.block<3, 3>(3, 3) = -back;
    by_view.block<3, 3>(0, kLidarColumns) = by_turn * turned;
    by_view.block<3, 3>(3, kLidarColumns + 3) = back * turned;
    by_view = (scale_.asDiagonal() * by_view).eval();
  }
  return true;
}

PriorCost::PriorCost(const SharedBlock& block, const double& weight)
    : block_(block), weight_(weight) {
  set_num_residuals(static_cast<int>(block.mean.size()));
  mutable_parameter_block_sizes()->push_back(static_cast<int>(block.mean.size()));
}

bool PriorCost::Evaluate(double const* const* parameters, double* residuals,
                         double** jacobians) const {
  const Eigen::Map<const Eigen::VectorXd> numbers(parameters[0], num_residuals());
  Eigen::Map<Eigen::VectorXd>(residuals, num_residuals()) =
      weight_ * (numbers - block_.mean).cwiseQuotient(block_.sigma);
  DerivativeBlock by = ZeroDerivative(jacobians, 0, num_residuals(), num_residuals());
  if (by.size() > 0) by.diagonal() = weight_ * block_.sigma.cwiseInverse();
  return true;
}

}  // namespace sextant
