// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/rigid3d.h"
#include "io/text/yaml_fields.h"

namespace sextant {

/// Directions of an object's axes in the world if it is not rotated.
enum class SceneAxes {
  kForwardIsX,  ///< x forward, y left, z up: LiDARs, boxes.
  kForwardIsZ,  ///< x right, y down, z forward: cameras, boards, walls; z points into boards and
                ///< walls.
};

/// Rotation of an object: starting from forward along the world's x with z up, by yaw (to the
/// left), then pitch (nose down), then roll (clockwise as seen along forward).
Eigen::Quaterniond SceneRotation(SceneAxes axes, const EulerZyx& euler);

/// world_from_object of a map with `position_m` and one of
/// - `yaw_deg`, `pitch_deg`, `roll_deg`, as SceneRotation has them (0 where absent);
/// - `facing_m` and `roll_deg`: the point in the world that a camera, LiDAR or box looks at, or
///   that sees the front of a board or wall squarely; upright before the roll;
/// - `quaternion_wxyz`: the rotation of world_from_object as it is.
/// Errors go to `in`.
Rigid3d ReadScenePose(YamlFields& in, const YamlNode& node, SceneAxes axes,
                      bool front_is_backward = false);

}  // namespace sextant
