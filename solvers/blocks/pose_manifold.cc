// SPDX-License-Identifier: Apache-2.0
#include "solvers/blocks/pose_manifold.h"

namespace sextant {
namespace {

void SetLeadingIdentity(double* jacobian, int rows, int columns) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(jacobian, rows, columns).setIdentity();
}

}  // namespace

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  for (int i = 0; i < poses_; ++i) {
    StorePose(Perturb(PoseIn(x + kPoseNumbers * i), Eigen::Map<const Vector6d>(delta + 6 * i)),
              x_plus_delta + kPoseNumbers * i);
  }
  return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  SetLeadingIdentity(jacobian, AmbientSize(), TangentSize());
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  for (int i = 0; i < poses_; ++i) {
    Eigen::Map<Vector6d>(y_minus_x + 6 * i) =
        PoseDifference(PoseIn(y + kPoseNumbers * i), PoseIn(x + kPoseNumbers * i));
  }
  return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  SetLeadingIdentity(jacobian, TangentSize(), AmbientSize());
  return true;
}

}  // namespace sextant
