// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>

#include "base/error.h"

namespace sextant {

/// The plane of nearly coplanar points: centroid, principal axes and standard deviations.
struct PlaneFrame {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();   ///< Unit columns: widest, second, normal.
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero();  ///< Standard deviation along each axis [m].
};

/// Least squares of the distances to the plane. The normal, with a far smaller deviation than the
/// other axes, comes from the adjugate of the covariance and the rest from a 2x2 problem, at a
/// fifth of the cost of an eigensolver.
///
/// Errors: kDegenerate where the points coincide, lie on one line, are so far away that rounding
/// destroys the translation, or are further off their plane than a tenth of its smaller extent:
/// points measured by a LiDAR are never exactly on it, those of two boards are clearly off.
Expected<PlaneFrame> FramePlane(std::span<const Eigen::Vector3d> points);

/// Projects every point onto their plane; does nothing where FramePlane finds none.
void FlattenOntoPlane(std::span<Eigen::Vector3d> points);

}  // namespace sextant
