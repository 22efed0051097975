// SPDX-License-Identifier: Apache-2.0
#include "io/blocks/pose_json.h"

#include <nlohmann/json.hpp>
#include <vector>

#include "base/units.h"

namespace sextant {

nlohmann::ordered_json PoseJson(const Rigid3d& pose) {
  const Eigen::Quaterniond& q = pose.rotation;
  const Eigen::Vector3d& t = pose.translation;
  const EulerZyx euler = ToEulerZyx(q);
  const Eigen::Matrix4d matrix = pose.Matrix();
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (int i = 0; i < 4; ++i) {
    rows.push_back({matrix(i, 0), matrix(i, 1), matrix(i, 2), matrix(i, 3)});
  }
  return {
      {"matrix", std::move(rows)},
      {"translation_m", {t.x(), t.y(), t.z()}},
      {"quaternion_wxyz", {q.w(), q.x(), q.y(), q.z()}},
      {"euler_zyx_deg",
       {euler.yaw * kDegPerRad, euler.pitch * kDegPerRad, euler.roll * kDegPerRad}},
  };
}

}  // namespace sextant
