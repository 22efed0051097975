// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/so3.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// Whitened residual of a pair and the factors of its analytic derivative: with
/// A = -dr / d(point in the camera frame) and d(R p + t) = -[R p]x dphi + dt of Perturb,
/// dr = A [R p]x dphi - A dt. A header, so that it is inlined into the loop of RefinePose.
template <int kResiduals>
struct TermDerivatives {
  Eigen::Matrix<double, kResiduals, 1> residual;
  Eigen::Matrix<double, kResiduals, 3> slope;  ///< A.
  Eigen::Vector3d arm;                         ///< R p.

  /// Derivative by (dphi, dt).
  Eigen::Matrix<double, kResiduals, 6> Jacobian() const {
    Eigen::Matrix<double, kResiduals, 6> jacobian;
    jacobian.template leftCols<3>() = slope * Hat(arm);
    jacobian.template rightCols<3>() = -slope;
    return jacobian;
  }
};

/// `r` is the rotation matrix of cam_from_lidar, `t` its translation. Always true: every point
/// has a residual.
inline bool Differentiate(const PointTerm& term, const Camera*, const Eigen::Matrix3d& r,
                          const Eigen::Vector3d& t, TermDerivatives<3>& out) {
  out.arm.noalias() = r * term.in_lidar;
  out.residual.noalias() = term.whitener * (term.in_cam - out.arm - t);
  out.slope = term.whitener;
  return true;
}

/// False where the point does not project.
inline bool Differentiate(const PixelTerm& term, const Camera* camera, const Eigen::Matrix3d& r,
                          const Eigen::Vector3d& t, TermDerivatives<2>& out) {
  out.arm.noalias() = r * term.in_lidar;
  const Eigen::Vector3d point = out.arm + t;
  const double s = term.inverse_sigma;
  if (camera->model == CameraModel::kPinhole) {
    if (!(point.z() > 0.0)) return false;
    const double inverse_z = 1.0 / point.z();
    const double fx = s * camera->fx_px * inverse_z;
    const double fy = s * camera->fy_px * inverse_z;
    const double u = fx * point.x();
    const double v = fy * point.y();
    out.residual.x() = s * (term.pixel.x() - camera->cx_px) - u;
    out.residual.y() = s * (term.pixel.y() - camera->cy_px) - v;
    out.slope << fx, 0.0, -u * inverse_z, 0.0, fy, -v * inverse_z;
    return true;
  }
  const std::optional<ProjectionWithJacobian> projected = ProjectWithJacobian(*camera, point);
  if (!projected) return false;
  out.residual = s * (term.pixel - projected->pixel);
  out.slope = s * projected->pixel_by_point;
  return true;
}

}  // namespace sextant
