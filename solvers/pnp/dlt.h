// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The pose of a calibrated camera by the direct linear transformation: the naive baseline.
///
/// argmin over all 3x4 matrices P with |last row| = 1 of sum_i |z_i (u_i, v_i) - (x_i, y_i)|^2,
/// (x, y, z)_i = P (p_i, 1), in coordinates of unit covariance; then the rotation nearest to the
/// left 3x3 part (Frobenius norm) and the translation divided by its mean scale. The five degrees
/// of freedom that P has beyond a pose are fitted to the noise and discarded, which is why this is
/// a baseline. Source: Abdel-Aziz and Karara 1971; Hartley and Zisserman 2004, section 7.1. With
/// the moments of image_moments.h the first two rows are U and V times the last, which reduces the
/// 12x12 problem to 4x4.
///
/// Shapes: image points (x/z, y/z), and as many points [m], at least 6 different ones.
/// Errors: kTooFewPairs; kDegenerate (fewer than 6 different points, all on one plane or on
/// another surface that does not fix P); kMirrored (a reflection fits better, as when all points
/// are behind the camera).
Expected<Rigid3d> SolveDlt(std::span<const Eigen::Vector2d> image_points,
                           std::span<const Eigen::Vector3d> points_in_lidar);

}  // namespace sextant
