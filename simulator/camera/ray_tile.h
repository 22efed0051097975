// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "geometry/camera.h"

namespace sextant {

/// Rays through the corners of a square block of pixels, and the cone they lie in.
///
/// Unprojecting every corner by Newton's method costs more than all the rest of a picture. A lens
/// is smooth, so 8 x 8 unprojected nodes and Lagrange's polynomial through them give the other
/// rays: to 1e-7 rad, or 1e-4 px, for the lenses of camera_model.h (tested). A block of which a
/// node has no ray is unprojected corner by corner.
class RayTile {
 public:
  static constexpr int kPixels = 34;  ///< A side; 32 and one around for its neighbours.
  static constexpr int kCorners = kPixels + 1;

  /// `left` and `top` number the block's first pixel; its first corner is at left - 0.5.
  RayTile(const Camera& camera, int left, int top);

  bool HasRay(int row, int column) const { return has_ray_[Index(row, column)]; }
  /// Of unit length, nearly. Requires HasRay.
  const Eigen::Vector3d& Ray(int row, int column) const { return rays_[Index(row, column)]; }

  /// Unit vector and angle of a cone that holds all rays that there are, if any.
  const Eigen::Vector3d& axis() const { return axis_; }
  double half_angle_rad() const { return half_angle_rad_; }
  bool any_ray() const { return any_ray_; }

 private:
  static std::size_t Index(int row, int column) {
    return static_cast<std::size_t>(row * kCorners + column);
  }
  bool Interpolate(const Camera& camera, double left, double top);
  void UnprojectAll(const Camera& camera, double left, double top);
  void FindCone();

  std::vector<Eigen::Vector3d> rays_;
  std::vector<bool> has_ray_;
  Eigen::Vector3d axis_ = Eigen::Vector3d::UnitZ();
  double half_angle_rad_ = 0.0;
  bool any_ray_ = false;
};

}  // namespace sextant
