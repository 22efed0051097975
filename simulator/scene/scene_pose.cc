// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_pose.h"

namespace sextant {

Eigen::Quaterniond SceneRotation(SceneAxes axes, const EulerZyx& euler) {
  Eigen::Quaterniond turned = FromEulerZyx(euler);
  if (axes == SceneAxes::kForwardIsX) return turned;
  Eigen::Matrix3d forward_left_up_from_axes;
  forward_left_up_from_axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return (turned * Eigen::Quaterniond(forward_left_up_from_axes)).normalized();
}

}  // namespace sextant
