// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/so3.h"
#include "solvers/pair_terms.h"

namespace sextant {

/// Whitened residual of a pair and its derivatives by (dphi, dt) of Perturb, by hand:
/// d(R p + t) = -[R p]x dphi + dt. In this header to be inlined into the loop of RefinePose.
template <int kResiduals>
struct TermDerivatives {
  Eigen::Matrix<double, kResiduals, 1> residual;
  Eigen::Matrix<double, kResiduals, 6> jacobian;
};

/// `r` is the rotation matrix of cam_from_lidar, `t` its translation. Always true: every point
/// has a residual.
inline bool Differentiate(const PointTerm& term, const Camera*, const Eigen::Matrix3d& r,
                          const Eigen::Vector3d& t, TermDerivatives<3>& out) {
  const Eigen::Vector3d arm = r * term.in_lidar;
  out.residual.noalias() = term.whitener * (term.in_cam - arm - t);
  out.jacobian.leftCols<3>().noalias() = term.whitener * Hat(arm);
  out.jacobian.rightCols<3>() = -term.whitener;
  return true;
}

/// False where the point does not project. `slope` below is the derivative of a pixel coordinate
/// by the point in the camera frame, so that its derivative by dphi is arm x slope.
inline bool Differentiate(const PixelTerm& term, const Camera* camera, const Eigen::Matrix3d& r,
                          const Eigen::Vector3d& t, TermDerivatives<2>& out) {
  const Eigen::Vector3d arm = r * term.in_lidar;
  const Eigen::Vector3d point = arm + t;
  const double s = term.inverse_sigma;
  const auto set_row = [&](int k, double projected, const Eigen::Vector3d& slope) {
    out.residual[k] = s * (term.pixel[k] - projected);
    out.jacobian.row(k).head<3>() = -s * arm.cross(slope);
    out.jacobian.row(k).tail<3>() = -s * slope;
  };
  if (camera->model == CameraModel::kPinhole) {
    if (!(point.z() > 0.0)) return false;
    const double inverse_z = 1.0 / point.z();
    const double u = camera->fx_px * point.x() * inverse_z;
    const double v = camera->fy_px * point.y() * inverse_z;
    set_row(0, u + camera->cx_px, {camera->fx_px * inverse_z, 0.0, -u * inverse_z});
    set_row(1, v + camera->cy_px, {0.0, camera->fy_px * inverse_z, -v * inverse_z});
    return true;
  }
  const std::optional<ProjectionWithJacobian> projected = ProjectWithJacobian(*camera, point);
  if (!projected) return false;
  for (int k = 0; k < 2; ++k) set_row(k, projected->pixel[k], projected->pixel_by_point.row(k));
  return true;
}

}  // namespace sextant
