// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "simulator/scene/scene.h"

namespace sextant {

/// Overlaps of up to this count as touching, not as crossing.
inline constexpr double kSceneTouch_m = 1e-3;

/// A rectangle in space: its frame is defined like a board's, with the sides along x and y.
struct SceneRectangle {
  Rigid3d world_from_plane{};
  double width_m = 0.0;
  double height_m = 0.0;

  /// Corners in the world, starting at (-x, -y), clockwise as seen along z.
  std::array<Eigen::Vector3d, 4> Corners() const;
  double DistanceTo(const Eigen::Vector3d& point_in_world) const;
};

/// Whether the rectangle intersects the other object by more than kSceneTouch_m.
bool Crosses(const SceneRectangle& a, const SceneRectangle& b);
bool Crosses(const SceneRectangle& rectangle, const SceneBox& box);
bool Crosses(const SceneRectangle& rectangle, const SceneCylinder& cylinder);

/// Whether the point is inside the object or on its surface.
bool IsInside(const Eigen::Vector3d& point_in_world, const SceneBox& box);
bool IsInside(const Eigen::Vector3d& point_in_world, const SceneCylinder& cylinder);

}  // namespace sextant
