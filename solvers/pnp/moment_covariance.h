// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>

#include "geometry/rigid3d.h"

namespace sextant {

/// The pose that an estimator finds for displaced image points of the same points; none where it
/// fails.
using PoseOfImage = std::function<std::optional<Rigid3d>(std::span<const Eigen::Vector2d>)>;

/// Covariance of (dphi, dt), to first order, of an estimator that is smooth in the image points
/// and depends on them only through their moments (dlt, epnp), in any way: the sums over i of u_i h
/// h^T, v_i h h^T and (u_i^2 + v_i^2) h h^T, h = (1, point i).
///
/// The derivative of the pose by the 2n image coordinates then lies in the space spanned by the
/// derivatives of these 30 sums. Its component along each vector of an orthonormal basis of that
/// space comes from a central difference of 1e-5; together they are the derivative, exactly. With
/// up to 15 points the basis spans all displacements, and any smooth estimator is allowed. Costs 2
/// min(2n, 30) calls of `estimate`, and time linear in n.
///
/// Shapes: as in ObjectSpaceCovariance. None where the estimator fails at displaced image points.
std::optional<Matrix6d> MomentCovariance(std::span<const Eigen::Vector2d> image_points,
                                         std::span<const Eigen::Matrix2d> image_covariances,
                                         std::span<const Eigen::Vector3d> points,
                                         const PoseOfImage& estimate);

}  // namespace sextant
