// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/camera.h"

namespace sextant {

/// Maps between the pixels of a camera and those of the same camera without distortion ("straight"
/// pixels), in which straight edges are straight. Without a camera both are the same.
class Undistortion {
 public:
  Undistortion() = default;
  explicit Undistortion(const Camera& camera) : camera_(camera) {}

  struct Point {
    Eigen::Vector2d straight_px = Eigen::Vector2d::Zero();
    Eigen::Matrix2d straight_by_pixel = Eigen::Matrix2d::Identity();
  };

  /// None outside the lens model's domain.
  std::optional<Point> Undistort(const Eigen::Vector2d& pixel) const;

  /// As Undistort to 1e-4 px, in a fraction of its time, for a pixel within a few px of `near_px`,
  /// whose undistorted point is `near`.
  std::optional<Point> UndistortNear(const Eigen::Vector2d& pixel, const Eigen::Vector2d& near_px,
                                     const Point& near) const;

  struct DistortedPoint {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Matrix2d pixel_by_straight = Eigen::Matrix2d::Identity();
  };
  std::optional<DistortedPoint> Distort(const Eigen::Vector2d& straight_px) const;

 private:
  std::optional<Camera> camera_;
};

}  // namespace sextant
