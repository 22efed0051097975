// SPDX-License-Identifier: Apache-2.0
#include "report/collect/pose_in_words.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"

namespace sextant {
namespace {

std::string Offset(double metres, const char* positive, const char* negative) {
  return fmt::format("{:.0f} mm {}", 1e3 * std::abs(metres), metres < 0.0 ? negative : positive);
}

std::string Turn(double radians, const char* positive, const char* negative) {
  return fmt::format("{:.1f} deg {}", kDegPerRad * std::abs(radians),
                     radians < 0.0 ? negative : positive);
}

}  // namespace

std::string PoseInWords(const Rigid3d& cam_from_lidar) {
  const Rigid3d lidar_from_cam = cam_from_lidar.Inverse();
  const Eigen::Vector3d& t = lidar_from_cam.translation;
  const Eigen::Matrix3d axes = lidar_from_cam.rotation.toRotationMatrix();
  const Eigen::Vector3d right = axes.col(0);
  const Eigen::Vector3d down = axes.col(1);
  const Eigen::Vector3d forward = axes.col(2);
  // Positive: the camera's right side is up.
  const double roll = std::atan2(right.z(), -down.z());
  return fmt::format(
      "The camera is {}, {} and {} the LiDAR. Its optical axis points {} and {} from the LiDAR's "
      "forward direction, and the camera is rolled {}, as seen from behind it.",
      Offset(t.x(), "in front of", "behind"), Offset(t.y(), "to the left of", "to the right of"),
      Offset(t.z(), "above", "below"),
      Turn(std::atan2(forward.y(), forward.x()), "to the left", "to the right"),
      Turn(std::asin(std::clamp(forward.z(), -1.0, 1.0)), "up", "down"),
      Turn(roll, "counter-clockwise", "clockwise"));
}

}  // namespace sextant
