// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/rigid_matrix.h"

#include <Eigen/LU>

#include "geometry/coordinate_range.h"

namespace sextant {

bool IsRotation(const Eigen::Matrix3d& matrix, double tolerance) {
  return (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm() < tolerance &&
         matrix.determinant() > 0.0;
}

std::optional<Rigid3d> RigidFromMatrix(const Eigen::Matrix4d& matrix) {
  constexpr double kTolerance = 1e-5;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  if (!IsRotation(rotation, kTolerance) || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    return std::nullopt;
  }
  if (!((matrix.topRightCorner<3, 1>().array().abs() <= kMaxCoordinate_m).all())) {
    return std::nullopt;
  }
  return Rigid3d{Eigen::Quaterniond(rotation).normalized(), matrix.topRightCorner<3, 1>()};
}

}  // namespace sextant
