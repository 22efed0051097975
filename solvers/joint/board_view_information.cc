// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/board_view_information.h"

#include <fmt/core.h>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

// Normal equations of one sensor for the pose of the board in its own frame.
struct PoseInformation {
  Matrix6d normal = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

template <class Residual>
void Add(const Residual& residual, PoseInformation& sum, double& cost) {
  sum.normal.noalias() += residual.by_pose.transpose() * residual.by_pose;
  sum.gradient.noalias() += residual.by_pose.transpose() * residual.value;
  if constexpr (std::is_same_v<Residual, PrintedResidual>) {
    cost += 0.5 * residual.value.squaredNorm();
  } else {
    cost += 0.5 * residual.value * residual.value;
  }
}

tl::unexpected<Error> NotSeen(const BoardView& view, const char* what) {
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("board {} of view {}: {} at these poses; expected poses near those "
                               "of the sensors",
                               view.board, view.view, what));
}

}  // namespace

Eigen::Matrix<double, 6, 12> RelativePoseByPoses(const Rigid3d& cam_from_lidar,
                                                 const Rigid3d& cam_from_board) {
  const Eigen::Matrix3d lidar_from_cam = cam_from_lidar.rotation.conjugate().toRotationMatrix();
  const Eigen::Vector3d arm = cam_from_board.translation - cam_from_lidar.translation;
  Eigen::Matrix<double, 6, 12> by_poses = Eigen::Matrix<double, 6, 12>::Zero();
  by_poses.block<3, 3>(0, 0) = -lidar_from_cam;
  by_poses.block<3, 3>(0, 6) = lidar_from_cam;
  by_poses.block<3, 3>(3, 0) = lidar_from_cam * Hat(arm);
  by_poses.block<3, 3>(3, 3) = -lidar_from_cam;
  by_poses.block<3, 3>(3, 9) = lidar_from_cam;
  return by_poses;
}

Expected<BoardViewInformation> InformationOfPoses(const BoardView& view, const Board& board,
                                                  const Camera& camera,
                                                  const Rigid3d& cam_from_lidar,
                                                  const Rigid3d& cam_from_board) {
  const BoardViewTerms terms = TermsOf(view, board);
  BoardViewInformation information;
  PoseInformation by_camera;
  PrintedResidual printed;
  for (const PrintedTerm& term : terms.printed) {
    if (!Differentiate(term, camera, cam_from_board, printed)) {
      return NotSeen(view, "a printed point does not project");
    }
    Add(printed, by_camera, information.cost);
  }
  const BoardPlane plane(cam_from_lidar.Inverse() * cam_from_board);
  PoseInformation by_lidar;
  RayResidual ray;
  const auto add_rays = [&](const auto& rays) {
    for (const auto& term : rays) {
      if (!Differentiate(term, plane, ray)) return false;
      Add(ray, by_lidar, information.cost);
    }
    return true;
  };
  if (!add_rays(terms.face) || !add_rays(terms.edges)) {
    return NotSeen(view, "a ray of the LiDAR does not meet the board's plane");
  }
  const Eigen::Matrix<double, 6, 12> chain = RelativePoseByPoses(cam_from_lidar, cam_from_board);
  information.normal = chain.transpose() * by_lidar.normal * chain;
  information.gradient = chain.transpose() * by_lidar.gradient;
  information.normal.bottomRightCorner<6, 6>() += by_camera.normal;
  information.gradient.tail<6>() += by_camera.gradient;
  return information;
}

Matrix6d PseudoInverse(const Matrix6d& information) {
  constexpr double kSmallestEigenvalue = 1e-12;
  const Vector6d scale =
      information.diagonal().unaryExpr([](double d) { return d > 0.0 ? 1.0 / std::sqrt(d) : 0.0; });
  const SymmetricEigen<6> eigen = EigenOf<6>(scale.asDiagonal() * information * scale.asDiagonal());
  const Vector6d inverse =
      eigen.values.unaryExpr([](double e) { return e > kSmallestEigenvalue ? 1.0 / e : 0.0; });
  const Matrix6d vectors = scale.asDiagonal() * eigen.vectors;
  return vectors * inverse.asDiagonal() * vectors.transpose();
}

Matrix6d EliminateBoard(const Matrix12d& normal) {
  const Matrix6d mixed = normal.topRightCorner<6, 6>();
  const Matrix6d left = normal.topLeftCorner<6, 6>() -
                        mixed * PseudoInverse(normal.bottomRightCorner<6, 6>()) * mixed.transpose();
  return 0.5 * (left + left.transpose());
}

Expected<Matrix6d> InformationOfView(const BoardView& view, const Board& board,
                                     const Camera& camera, const Rigid3d& cam_from_lidar,
                                     const Rigid3d& cam_from_board) {
  return InformationOfPoses(view, board, camera, cam_from_lidar, cam_from_board)
      .map([](const BoardViewInformation& information) {
        return EliminateBoard(information.normal);
      });
}

}  // namespace sextant
