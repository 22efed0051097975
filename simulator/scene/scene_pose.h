// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/rigid3d.h"

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

}  // namespace sextant
