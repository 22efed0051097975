// SPDX-License-Identifier: Apache-2.0
#include "io/export/export_rig.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <vector>

#include "io/export/export_texts.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

std::vector<NamedTransform> TreeOf(const RigResult& result) {
  std::vector<NamedTransform> tree;
  for (const RigResultSensor& sensor : result.sensors) {
    if (!sensor.root_from_sensor || sensor.name == result.root) continue;
    tree.push_back({.parent = result.root,
                    .child = sensor.name,
                    .parent_from_child = *sensor.root_from_sensor,
                    .camera_frame = sensor.camera ? sensor.name : ""});
  }
  return tree;
}

// The comment comes last because some readers count lines.
Expected<std::string> KittiRigText(const RigResult& result) {
  std::string text;
  for (const RigResultSensor& camera : result.sensors) {
    if (!camera.camera || !camera.root_from_sensor) continue;
    Eigen::Matrix<double, 3, 4> p = Eigen::Matrix<double, 3, 4>::Zero();
    p << camera.camera->fx_px, camera.camera->skew_px, camera.camera->cx_px, 0.0, 0.0,
        camera.camera->fy_px, camera.camera->cy_px, 0.0, 0.0, 0.0, 1.0, 0.0;
    text += fmt::format("P_{}: {}\n", camera.name, NumbersByRow(p, " "));
    for (const RigResultSensor& lidar : result.sensors) {
      if (lidar.camera || !lidar.root_from_sensor) continue;
      SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, result.Between(camera.name, lidar.name));
      text += fmt::format("Tr_{}_to_{}: {}\n", lidar.name, camera.name,
                          NumbersByRow(pose.Matrix().topRows<3>(), " "));
    }
  }
  if (text.empty()) {
    return MakeError(ErrorCode::kMissingData, "the format kitti needs a camera in the rig");
  }
  return text +
         "# Tr_a_to_b is b_from_a: point_in_b = Tr_a_to_b * point_in_a. P is of undistorted "
         "images\n";
}

}  // namespace

Expected<std::string> ExportRig(std::string_view format, const RigResult& result) {
  const std::vector<NamedTransform> tree = TreeOf(result);
  if (tree.empty()) {
    return MakeError(ErrorCode::kMissingData, "expected a rig with two connected sensors or more");
  }
  for (const RigResultSensor& sensor : result.sensors) {
    SEXTANT_RETURN_IF_ERROR(CheckFrame(sensor.name, "sensor"));
  }
  if (format == "ros1") return Ros1LaunchText(tree);
  if (format == "ros2") return Ros2LaunchText(tree);
  if (format == "ros2_yaml") return Ros2YamlText(tree);
  if (format == "urdf") return UrdfText(tree);
  if (format == "kitti") return KittiRigText(result);
  return MakeError(
      ErrorCode::kUnknownName,
      fmt::format("no format {} for a rig; expected ros1, ros2, ros2_yaml, urdf or kitti, or name "
                  "two sensors with --sensors for the formats of one pair",
                  Quoted(format)));
}

Expected<CalibrationResult> ResultOfPair(const RigResult& result, std::string_view a,
                                         std::string_view b) {
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d a_from_b, result.Between(a, b));
  if (a == b) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("expected two sensors, got {} twice", Quoted(a)));
  }
  CalibrationResult pair;
  pair.version = result.version;
  pair.camera_frame = a;
  pair.lidar_frame = b;
  pair.cam_from_lidar = a_from_b;
  pair.camera = result.Find(a)->camera;
  if (!result.refutations.empty()) {
    pair.verdict = ResultVerdict{.usability = Usability::kNotUsable,
                                 .reason = result.refutations[0],
                                 .next = "Correct it and solve the rig again"};
  }
  return pair;
}

}  // namespace sextant
