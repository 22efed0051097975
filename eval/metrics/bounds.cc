// SPDX-License-Identifier: Apache-2.0
#include "eval/metrics/bounds.h"

#include <Eigen/Cholesky>
#include <cassert>
#include <cmath>
#include <vector>

#include "geometry/pair_noise.h"
#include "geometry/symmetric.h"
#include "solvers/core/board_view_check.h"
#include "solvers/joint/board_view_information.h"
#include "solvers/joint/joint_noise.h"
#include "solvers/joint/joint_problem.h"

namespace sextant {
namespace {

// Derivative of R p + t by (dphi, dt) at R p = arm.
Eigen::Matrix<double, 3, 6> PointByPose(const Eigen::Vector3d& arm) {
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << -Hat(arm), Eigen::Matrix3d::Identity();
  return jacobian;
}

Expected<void> AddInformation(const CalibrationProblem& problem, const Rigid3d& pose,
                              const Pair2d3d& pair, Matrix6d& information) {
  const Eigen::Vector3d arm = pose.rotation * pair.point_in_lidar;
  const auto projection = ProjectWithJacobian(*problem.camera, arm + pose.translation);
  if (!projection) {
    return MakeError(ErrorCode::kInvalidInput,
                     "a point of the 2D-3D pairs does not project under the true pose");
  }
  const Eigen::Matrix<double, 2, 6> jacobian = projection->pixel_by_point * PointByPose(arm);
  information += jacobian.transpose() * jacobian / (pair.sigma_px * pair.sigma_px);
  return {};
}

Expected<void> CheckViews(const CalibrationProblem& problem) {
  if (problem.board_views.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "the bound of raw data needs views of boards, and the problem has none");
  }
  if (!problem.camera) {
    return MakeError(ErrorCode::kInvalidInput, "the bound of raw data needs the camera");
  }
  return CheckBoardViews(problem.board_views, problem.boards);
}

tl::unexpected<Error> UndeterminedByViews() {
  return MakeError(ErrorCode::kDegenerate, "the views leave a direction of the pose undetermined");
}

// Every observation counts as stated, and both sensors see a board in one pose.
std::vector<JointWeights> StatedWeights(const JointModel& model) {
  std::vector<JointWeights> weights;
  for (const JointView& view : model.views) {
    weights.push_back({std::vector<double>(view.terms.printed.size(), 1.0),
                       std::vector<double>(view.terms.face.size(), 1.0),
                       std::vector<double>(view.terms.edges.size(), 1.0),
                       Vector6d::Constant(1.0 / kNoShift_m), 1.0});
  }
  return weights;
}

}  // namespace

Expected<Matrix6d> CramerRaoBound(const CalibrationProblem& problem,
                                  const Rigid3d& true_cam_from_lidar) {
  if (problem.pairs_3d3d.empty() && problem.pairs_2d3d.empty()) {
    return MakeError(ErrorCode::kMissingData, "the bound needs pairs, and the problem has none");
  }
  if (!problem.pairs_2d3d.empty() && !problem.camera) {
    return MakeError(ErrorCode::kInvalidInput, "the bound of 2D-3D pairs needs the camera");
  }
  const auto no_noise = [] {
    return MakeError(ErrorCode::kMissingData, "the bound needs pairs that state their noise");
  };
  Matrix6d information = Matrix6d::Zero();
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    if (!HasKnownNoise(pair)) return no_noise();
    const auto jacobian = PointByPose(true_cam_from_lidar.rotation * pair.point_in_lidar);
    information += jacobian.transpose() * StatedCovariance(pair).llt().solve(jacobian);
  }
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    if (!HasKnownNoise(pair)) return no_noise();
    SEXTANT_RETURN_IF_ERROR(AddInformation(problem, true_cam_from_lidar, pair, information));
  }
  const std::optional<Matrix6d> bound = InvertSymmetric(information);
  if (!bound) {
    return MakeError(ErrorCode::kDegenerate,
                     "the pairs leave a direction of the pose undetermined");
  }
  return *bound;
}

Expected<Matrix6d> CramerRaoBoundOfViews(const CalibrationProblem& problem,
                                         const Rigid3d& true_cam_from_lidar,
                                         std::span<const Rigid3d> true_cam_from_board) {
  assert(true_cam_from_board.size() == problem.board_views.size());
  SEXTANT_RETURN_IF_ERROR(CheckViews(problem));
  Matrix6d sum = Matrix6d::Zero();
  for (std::size_t i = 0; i < problem.board_views.size(); ++i) {
    const BoardView& view = problem.board_views[i];
    SEXTANT_ASSIGN_OR_RETURN(
        const Matrix6d information,
        InformationOfView(view, *FindBoard(problem.boards, view.board), *problem.camera,
                          true_cam_from_lidar, true_cam_from_board[i]));
    sum += information;
  }
  const std::optional<Matrix6d> bound = InvertSymmetric(sum);
  if (!bound) return UndeterminedByViews();
  return *bound;
}

Expected<Matrix6d> CramerRaoBoundOfSession(const CalibrationProblem& problem,
                                           const Rigid3d& true_cam_from_lidar,
                                           std::span<const Rigid3d> true_cam_from_board) {
  assert(true_cam_from_board.size() == problem.board_views.size());
  SEXTANT_RETURN_IF_ERROR(CheckViews(problem));
  SEXTANT_ASSIGN_OR_RETURN(const JointModel model, ModelOf(problem, {}));
  JointState truth{true_cam_from_lidar, {}, {}};
  for (const Rigid3d& cam_from_board : true_cam_from_board) {
    truth.boards.push_back({cam_from_board, true_cam_from_lidar.Inverse() * cam_from_board});
  }
  for (const SharedBlock& block : model.shared) truth.shared.push_back(block.mean);
  JointProblem at_truth(model, truth);
  at_truth.SetWeights(StatedWeights(model), 1.0);
  const auto covariance = JointCovariance::Of(at_truth.Linearise());
  if (!covariance) return UndeterminedByViews();
  return Matrix6d(covariance->shared().topLeftCorner<6, 6>());
}

RmsError RmsOf(const Matrix6d& covariance) {
  return {std::sqrt(covariance.topLeftCorner<3, 3>().trace()),
          std::sqrt(covariance.bottomRightCorner<3, 3>().trace())};
}

}  // namespace sextant
