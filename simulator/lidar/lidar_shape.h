// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>

#include "geometry/board.h"

namespace sextant {

/// Of a laser, in the frame of whatever it is cast at. `direction` is of unit length.
struct LidarRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
};

/// Where a ray enters a shape from outside.
struct LidarEntry {
  double range_m = 0.0;
  /// 0 to 2: the face across that axis. Cylinders: 0 the side, 2 an end.
  int face = 0;
};

/// An upright rectangular block, perhaps without height along z and with a rectangular opening
/// through it along z: boards, walls, boxes. Bounds in its own frame [m].
struct LidarBlock {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  bool has_hole = false;
  Eigen::Vector2d hole_low = Eigen::Vector2d::Zero();
  Eigen::Vector2d hole_high = Eigen::Vector2d::Zero();

  /// None for a ray that passes by, begins inside, or goes through the opening.
  std::optional<LidarEntry> Enter(const LidarRay& ray) const;

  /// Whether all rays within `radius_m` of this one, parallel to it, enter by the same face.
  bool AllEnter(const LidarRay& ray, const LidarEntry& entry, double radius_m) const;

  /// Range from which on a parallel ray within `radius_m` may enter (0: from the start); none where
  /// none does. Never too far; may tell a range where none is.
  std::optional<double> MayEnter(const LidarRay& ray, double radius_m) const;
};

/// A closed cylinder along z from 0 to its height.
struct LidarCylinder {
  double radius_m = 0.0;
  double height_m = 0.0;

  std::optional<LidarEntry> Enter(const LidarRay& ray) const;
  bool AllEnter(const LidarRay& ray, const LidarEntry& entry, double radius_m) const;
  std::optional<double> MayEnter(const LidarRay& ray, double radius_m) const;
};

}  // namespace sextant
