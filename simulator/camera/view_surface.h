// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/rigid3d.h"
#include "simulator/camera/lighting.h"
#include "simulator/scene/board_print.h"
#include "simulator/scene/scene.h"

namespace sextant {

/// The hit of a ray from the camera's centre on one surface.
struct ViewHit {
  /// Inverse of the distance, in lengths of the ray that was cast; 0: no hit.
  double inverse_range = 0.0;
  double u_m = 0.0;  ///< Rectangle: position along x. Cylinder: height along the axis.
  double v_m = 0.0;  ///< Rectangle: position along y. Cylinder: 0 for the side, 1 for an end.
};

/// A patch of uniform radiance: between two points of the same layer and cell of a surface lies
/// only that patch, unless another layer or surface interrupts it.
struct ViewPatch {
  int layer = 0;
  int cell = 0;
  double radiance = 0.0;  ///< 1 for a white surface that faces the lamp.
};

/// A flat face of an object in the frame of one camera, whose centre is the origin of all rays.
///
/// With the plane n X = d and X = o + u x + v y, the ray r hits it at X = r / s with s = n r / d,
/// and (u, v) = (x r, y r) / s - (x o, y o): a homography of the ray.
struct ViewRectangle {
  Eigen::Matrix3d plane_from_ray = Eigen::Matrix3d::Zero();  ///< Maps a ray to (u s, v s, s).
  double half_width_m = 0.0;
  double half_height_m = 0.0;
  std::optional<BoardHole> hole{};
  std::vector<RoundHole> round_holes{};
  std::optional<BoardPrint> print{};  ///< If none, the face is plain, or tiled if tile_m > 0.
  double tile_m = 0.0;
  int tile_columns = 1;   ///< For tile_m > 0.
  bool speckled = false;  ///< Each tile has its own radiance between black and white.
  double white = 0.0;     ///< Radiance.
  double black = 0.0;
  Eigen::Vector3d center_in_cam = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal_in_cam = Eigen::Vector3d::Zero();  ///< Normal of the visible side.

  std::optional<ViewHit> Meet(const Eigen::Vector3d& ray) const {
    return HitAt(plane_from_ray * ray);
  }
  /// The hit of the ray that plane_from_ray maps to `scaled`.
  std::optional<ViewHit> HitAt(const Eigen::Vector3d& scaled) const;
  ViewPatch PatchAt(const ViewHit& hit) const;
};

/// Makes a face from the rectangle's pose; none if the camera is in its plane and does not see it.
std::optional<ViewRectangle> MakeViewRectangle(const Rigid3d& cam_from_rectangle, double width_m,
                                               double height_m);

/// An upright cylinder with its flat ends, seen from outside.
struct ViewCylinder {
  Eigen::Vector3d base_in_cam = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis_in_cam = Eigen::Vector3d::Zero();  ///< Unit vector, upwards.
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
