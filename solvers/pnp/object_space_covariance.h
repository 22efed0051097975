// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"

namespace sextant {

/// Covariance of (dphi, dt) of the pose that minimises sum_i |x_i - u_i z_i|^2 + |y_i - v_i z_i|^2
/// over all poses (sqpnp, ippe), by the implicit function theorem.
///
/// The gradient g(pose, image) vanishes at the minimum, so the pose moves by -H^-1 dg/d(u_i, v_i)
/// with the image, where H is the exact second derivative, and the covariance is
/// H^-1 (sum_i G_i Sigma_i G_i^T) H^-1, G_i = dg/d(u_i, v_i) (6x2). One pass over the points.
///
/// Shapes: image points (x/z, y/z) with their covariances, and as many points [m]; `pose` takes
/// the points into the frame of the image points and is a minimum. None where H is not positive
/// definite.
std::optional<Matrix6d> ObjectSpaceCovariance(std::span<const Eigen::Vector2d> image_points,
                                              std::span<const Eigen::Matrix2d> image_covariances,
                                              std::span<const Eigen::Vector3d> points,
                                              const Rigid3d& pose);

}  // namespace sextant
