// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "geometry/board.h"

namespace sextant {

/// A laser ray in the frame of the object that it is cast at. `direction` has unit length.
struct LidarRay {
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Vector3d direction = Eigen::Vector3d::UnitX();
};

/// The point where a ray enters a shape from outside.
struct LidarEntry {
  double range_m = 0.0;
  /// 0 to 2: a face normal to this axis. Cylinders: 0 is the side, 2 an end.
  int face = 0;
};

/// An axis-aligned rectangular block for boards, walls and boxes. It may have no thickness along z
/// and openings through it along z, one rectangular and any number of round ones. Bounds in its own
/// frame [m].
struct LidarBlock {
  Eigen::Vector3d low = Eigen::Vector3d::Zero();
  Eigen::Vector3d high = Eigen::Vector3d::Zero();
  bool has_hole = false;
  Eigen::Vector2d hole_low = Eigen::Vector2d::Zero();
  Eigen::Vector2d hole_high = Eigen::Vector2d::Zero();
  std::vector<RoundHole> round_holes{};

  /// None for a ray that misses, starts inside, or passes through an opening.
  std::optional<LidarEntry> Enter(const LidarRay& ray) const;

  /// Whether all parallel rays within `radius_m` of this one enter through the same face.
  bool AllEnter(const LidarRay& ray, const LidarEntry& entry, double radius_m) const;

  /// Lower bound of the range at which a parallel ray within `radius_m` may enter (0: from the
  /// start); none if no such ray enters. Conservative: the bound is never too large, and may exist
  /// although no ray enters.
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
