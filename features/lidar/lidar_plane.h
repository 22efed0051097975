// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "base/random.h"

namespace sextant {

/// A plane with axes in it: point = origin + x_axis * x + y_axis * y. Orthonormal, right-handed:
/// x right and y down as seen from the sensor, the normal away from it, as in a Board's frame.
struct LidarPlane {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< Centroid of its points [m].
  Eigen::Vector3d x_axis = Eigen::Vector3d::UnitX();
  Eigen::Vector3d y_axis = Eigen::Vector3d::UnitY();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
  double sigma_m = 0.0;  ///< Standard deviation of its points along the normal.
  /// Covariance of (offset along the normal at the origin [m], slopes along x and y [-]).
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();

  Eigen::Vector3d At(const Eigen::Vector2d& in_plane) const {
    return origin + x_axis * in_plane.x() + y_axis * in_plane.y();
  }
  /// Where a ray from the sensor meets the plane; none if it is parallel or points away from it.
  std::optional<Eigen::Vector2d> Meet(const Eigen::Vector3d& direction) const;
};

struct PlaneSearch {
  double threshold_m = 0.03;  ///< Distance up to which a return may belong to the plane.
  int iterations = 100;
  double smallest_share = 0.4;  ///< Minimum fraction of the points on the plane.
};

struct FoundPlane {
  LidarPlane plane;
  std::vector<int> inliers;  ///< Ascending indices of the points within 3 sigma of it.
};

/// RANSAC, then least squares of the distances over the points within 3 sigma until these no longer
/// change. None for fewer than six points, collinear points, a plane with too small a fraction of
/// the points, and one that is nearly edge-on to the sensor (less than 8 degrees).
std::optional<FoundPlane> FindPlane(std::span<const Eigen::Vector3d> points,
                                    const PlaneSearch& search, Random& random);

}  // namespace sextant
