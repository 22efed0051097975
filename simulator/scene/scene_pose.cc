// SPDX-License-Identifier: Apache-2.0
#include "simulator/scene/scene_pose.h"

#include <cmath>

#include "base/units.h"

namespace sextant {
namespace {

// The upright attitude whose forward axis points along `direction`.
EulerZyx Along(const Eigen::Vector3d& direction) {
  const double level = std::hypot(direction.x(), direction.y());
  return {.yaw = level > 0.0 ? std::atan2(direction.y(), direction.x()) : 0.0,
          .pitch = -std::atan2(direction.z(), level)};
}

Eigen::Quaterniond ReadQuaternion(YamlFields& in, const YamlNode& node) {
  double wxyz[4] = {1.0, 0.0, 0.0, 0.0};
  in.Reals(node, "quaternion_wxyz", wxyz);
  const Eigen::Quaterniond q(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  constexpr double kTolerance = 1e-3;
  if (in.ok() && std::abs(q.norm() - 1.0) > kTolerance) {
    in.Fail(node.line, "quaternion_wxyz", "expected a quaternion of length 1");
  }
  // A quaternion that was written with all digits is used bit by bit.
  constexpr double kRounding = 1e-14;
  return std::abs(q.norm() - 1.0) < kRounding ? q : q.normalized();
}

}  // namespace

Eigen::Quaterniond SceneRotation(SceneAxes axes, const EulerZyx& euler) {
  Eigen::Quaterniond turned = FromEulerZyx(euler);
  if (axes == SceneAxes::kForwardIsX) return turned;
  Eigen::Matrix3d forward_left_up_from_axes;
  forward_left_up_from_axes << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  return (turned * Eigen::Quaterniond(forward_left_up_from_axes)).normalized();
}

Rigid3d ReadScenePose(YamlFields& in, const YamlNode& node, SceneAxes axes,
                      bool front_is_backward) {
  static const std::vector<std::string> kKeys = {"position_m", "yaw_deg",  "pitch_deg",
                                                 "roll_deg",   "facing_m", "quaternion_wxyz"};
  Rigid3d pose;
  if (!in.IsMap(node, "pose", kKeys)) return pose;
  pose.translation = in.PointAt(node, "position_m");
  const bool has_angles = node.Find("yaw_deg") != nullptr || node.Find("pitch_deg") != nullptr;
  const YamlNode* facing = node.Find("facing_m");
  const YamlNode* quaternion = node.Find("quaternion_wxyz");
  if ((quaternion != nullptr && (facing != nullptr || node.Find("roll_deg") != nullptr)) ||
      (has_angles && (facing != nullptr || quaternion != nullptr))) {
    in.Fail(node.line, "pose",
            "expected one of: yaw_deg, pitch_deg and roll_deg; facing_m and roll_deg; "
            "quaternion_wxyz");
    return pose;
  }
  if (quaternion != nullptr) {
    pose.rotation = ReadQuaternion(in, *quaternion);
    return pose;
  }
  EulerZyx euler;
  if (facing != nullptr) {
    const Eigen::Vector3d toward = in.Point(*facing, "facing_m") - pose.translation;
    if (in.ok() && !(toward.norm() > 0.0)) {
      in.Fail(facing->line, "facing_m", "expected another point than position_m");
    }
    euler = Along(front_is_backward ? -toward : toward);
  } else {
    euler.yaw = kRadPerDeg * in.RealAt(node, "yaw_deg", 0.0);
    euler.pitch = kRadPerDeg * in.RealAt(node, "pitch_deg", 0.0);
  }
  euler.roll = kRadPerDeg * in.RealAt(node, "roll_deg", 0.0);
  pose.rotation = SceneRotation(axes, euler);
  return pose;
}

}  // namespace sextant
