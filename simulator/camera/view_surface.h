// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/rigid3d.h"
#include "simulator/camera/lighting.h"
#include "simulator/scene/board_print.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// What a ray from the camera's centre meets on one surface.
struct ViewHit {
  double inverse_range = 0.0;  ///< 1 / length, in lengths of the ray that was cast; 0: nothing.
  double u_m = 0.0;            ///< Rectangle: along its x. Cylinder: along its axis.
  double v_m = 0.0;            ///< Rectangle: along its y. Cylinder: 0 side, 1 end.
};

/// A patch of even brightness: between two points of one layer and cell of a surface lies only that
/// patch, unless another layer or surface comes between.
struct ViewPatch {
  int layer = 0;
  int cell = 0;
  double radiance = 0.0;  ///< 1: a white surface that squarely faces the lamp.
};

/// A flat side of something, in the frame of one camera, whose centre all rays leave.
///
/// With the plane n X = d and X = o + u x + v y, the ray r meets it at X = r / s, s = n r / d, and
/// (u, v) = (x r, y r) / s - (x o, y o): a homography of the ray.
struct ViewRectangle {
  Eigen::Matrix3d plane_from_ray = Eigen::Matrix3d::Zero();  ///< Rows give u s, v s and s.
  double half_width_m = 0.0;
  double half_height_m = 0.0;
  std::optional<BoardHole> hole{};
  std::optional<BoardPrint> print{};  ///< None: plain, or in squares of tile_m where that is > 0.
  double tile_m = 0.0;
  bool speckled = false;  ///< Each square has a radiance of its own, between black and white.
  double white = 0.0;     ///< Radiance.
  double black = 0.0;
  Eigen::Vector3d center_in_cam = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_in_cam = Eigen::Vector3d::Zero();  ///< Of the side that is seen.

  std::optional<ViewHit> Meet(const Eigen::Vector3d& ray) const;
  ViewPatch PatchAt(const ViewHit& hit) const;
};

/// Where a rectangle stands; none for a camera in its plane, which does not see it.
std::optional<ViewRectangle> MakeViewRectangle(const Rigid3d& cam_from_rectangle, double width_m,
                                               double height_m);

/// An upright cylinder with its flat ends, seen from outside.
struct ViewCylinder {
  Eigen::Vector3d base_in_cam = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_in_cam = Eigen::Vector3d::Zero();  ///< Unit, upwards.
  double radius_m = 0.0;
  double height_m = 0.0;
  double albedo = 0.0;
  Lighting lighting{};
  Eigen::Matrix3d world_from_cam = Eigen::Matrix3d::Identity();

  std::optional<ViewHit> Meet(const Eigen::Vector3d& ray) const;
  Eigen::Vector3d NormalAt(const ViewHit& hit, const Eigen::Vector3d& ray) const;
  ViewPatch PatchAt(const ViewHit& hit, const Eigen::Vector3d& ray) const;
};

}  // namespace sextant
