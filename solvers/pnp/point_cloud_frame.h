// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>

#include "base/error.h"

namespace sextant {

/// Points within 1e-5 of their length of a line leave the rotation about it to rounding.
inline constexpr double kMinLineVariance = 1e-10;

/// Doubles have a resolution of 1e-8 m at this distance.
inline constexpr double kMaxDistance_m = 1e8;

/// The centroid and the principal axes of a point set, widest first, right-handed.
struct PointCloudFrame {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();   ///< Unit columns.
  Eigen::Vector3d deviation = Eigen::Vector3d::Zero();  ///< Standard deviation along each axis [m].
  int different_count = 0;                              ///< Number of different points, up to 6.
  std::array<std::size_t, 6> different{};  ///< Indices of the first different_count of them.

  bool IsPlanar() const { return deviation.z() < 1e-6 * deviation.x(); }
};

/// Errors: kDegenerate where the points do not determine a pose: fewer than `min_different`
/// different points, all on one line, or so far away that rounding destroys the translation.
Expected<PointCloudFrame> FramePointCloud(std::span<const Eigen::Vector3d> points,
                                          int min_different);

}  // namespace sextant
