// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant::test {

/// A scene of a VLP-16 and these cameras (YAML list items), before two boards that swing slowly and
/// widely, so that they are in a different place in each scan.
inline std::string SwingingScene(const std::string& name, const std::string& cameras) {
  return "sextant_scene: 1\nname: " + name + R"(
lidar: {model: vlp16, pose: {position_m: [0, 0, 1]}}
cameras:
)" + cameras +
         R"(boards:
  - board:
      id: 0
      top_right_m: 0.468
      right_bottom_m: 0.484
      tags: [{family: aruco_original, id: 26, edge_m: 0.205}]
    pose: {position_m: [1.9, 0.5, 1], yaw_deg: 15, pitch_deg: 5, roll_deg: 45}
    swing: {axis_in_world: [0, 1, 0], amplitude_deg: 20, period_s: 400}
  - board:
      id: 1
      top_right_m: 0.468
      right_bottom_m: 0.49
      tags: [{family: aruco_original, id: 582, edge_m: 0.205}]
    pose: {position_m: [2.3, -0.55, 1.05], yaw_deg: -20, pitch_deg: -5, roll_deg: 42}
    swing: {axis_in_world: [0, 1, 0.3], amplitude_deg: 20, period_s: 300, phase_deg: 100}
walls:
  - {name: back, width_m: 8, height_m: 4, pose: {position_m: [4.5, 0, 1.5]}}
)";
}

}  // namespace sextant::test
