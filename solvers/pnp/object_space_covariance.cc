// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/object_space_covariance.h"

#include "geometry/so3.h"
#include "geometry/symmetric.h"
#include "solvers/least_squares/refine_pose.h"

namespace sextant {

std::optional<Matrix6d> ObjectSpaceCovariance(std::span<const Eigen::Vector2d> image_points,
                                              std::span<const Eigen::Matrix2d> image_covariances,
                                              std::span<const Eigen::Vector3d> points,
                                              const Rigid3d& pose) {
  const Eigen::Matrix3d rotation = pose.rotation.toRotationMatrix();
  Matrix6d hessian = Matrix6d::Zero();
  Matrix6d noise = Matrix6d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double u = image_points[i].x();
    const double v = image_points[i].y();
    const Eigen::Vector3d arm = rotation * points[i];
    const Eigen::Vector3d in_cam = arm + pose.translation;
    const Eigen::Vector2d error = in_cam.head<2>() - in_cam.z() * image_points[i];
    Eigen::Matrix<double, 2, 6> slope;  // Derivative of the error by (dphi, dt).
    for (int axis = 0; axis < 2; ++axis) {
      Eigen::Vector3d by_point = Eigen::Vector3d::Unit(axis);
      by_point.z() = -image_points[i](axis);
      slope.row(axis) << arm.cross(by_point).transpose(), by_point.transpose();
    }
    hessian.noalias() += slope.transpose() * slope;
    // Second derivative of Exp(dphi) arm, times the derivative of the cost by the point.
    const Eigen::Vector3d force(error.x(), error.y(), -u * error.x() - v * error.y());
    hessian.topLeftCorner<3, 3>() += 0.5 * (arm * force.transpose() + force * arm.transpose()) -
                                     arm.dot(force) * Eigen::Matrix3d::Identity();

    Eigen::Matrix<double, 3, 2> force_by_image;
    force_by_image << -in_cam.z(), 0.0, 0.0, -in_cam.z(), u * in_cam.z() - error.x(),
        v * in_cam.z() - error.y();
    Eigen::Matrix<double, 6, 2> gradient_by_image;
    gradient_by_image << Hat(arm) * force_by_image, force_by_image;
    noise.noalias() += gradient_by_image * image_covariances[i] * gradient_by_image.transpose();
  }
  const std::optional<Matrix6d> inverse = InvertSymmetric(hessian);
  if (!inverse) return std::nullopt;
  const Matrix6d covariance = *inverse * noise * *inverse;
  return Matrix6d(0.5 * (covariance + covariance.transpose()));
}

}  // namespace sextant
