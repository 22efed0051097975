// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>

#include "simulator/scene/scene.h"

namespace sextant {

/// Touching with up to this is no crossing.
inline constexpr double kSceneTouch_m = 1e-3;

/// A rectangle in space: axes of world_from_plane as a board's, sides along x and y.
struct SceneRectangle {
  Rigid3d world_from_plane{};
  double width_m = 0.0;
  double height_m = 0.0;

  /// From (-x, -y), clockwise as seen along z.
  std::array<Eigen::Vector3d, 4> Corners() const;
  double DistanceTo(const Eigen::Vector3d& point_in_world) const;
};

bool Crosses(const SceneRectangle& a, const SceneRectangle& b);
bool Crosses(const SceneRectangle& rectangle, const SceneBox& box);
bool Crosses(const SceneRectangle& rectangle, const SceneCylinder& cylinder);

bool IsInside(const Eigen::Vector3d& point_in_world, const SceneBox& box);
bool IsInside(const Eigen::Vector3d& point_in_world, const SceneCylinder& cylinder);

}  // namespace sextant
