// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "geometry/camera.h"

namespace sextant {

/// Rays through the pixel corners of a square block of pixels, and a cone that contains them.
///
/// Unprojecting every corner with Newton's method would take more time than the rest of the
/// rendering. As lenses are smooth, 8 x 8 unprojected nodes and the Lagrange polynomial through
/// them give the other rays, to 1e-7 rad or 1e-4 px for the lenses of camera_model.h (tested). If a
/// node has no ray, all corners of the block are unprojected.
class RayTile {
 public:
  /// Pixels per side: 32, and one on each side for the neighbours.
  static constexpr int kPixels = 34;
  static constexpr int kCorners = kPixels + 1;

  /// `left` and `top` are the block's first pixel; its first corner is at left - 0.5.
  RayTile(const Camera& camera, int left, int top);

  bool HasRay(int row, int column) const { return has_ray_[Index(row, column)]; }
  /// A ray of nearly unit length. Requires HasRay.
  const Eigen::Vector3d& Ray(int row, int column) const { return rays_[Index(row, column)]; }

  /// Axis (unit vector) and half angle of a cone that contains all existing rays, if there are any.
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
