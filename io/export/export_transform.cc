// SPDX-License-Identifier: Apache-2.0
#include "io/export/export_transform.h"

#include <fmt/core.h>

#include <algorithm>
#include <span>

#include "base/nearest_name.h"
#include "base/text/file_name.h"
#include "io/export/export_texts.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

Expected<void> CheckFrames(const ExportOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckFrame(options.camera_frame, "camera"));
  SEXTANT_RETURN_IF_ERROR(CheckFrame(options.lidar_frame, "LiDAR"));
  if (options.camera_frame != options.lidar_frame) return {};
  return MakeError(
      ErrorCode::kInvalidOption,
      fmt::format("both frames are named {}: expected two names", Quoted(options.camera_frame)));
}

NamedTransform Named(const CalibrationResult& result, const ExportOptions& options) {
  if (options.lidar_is_parent) {
    return {.parent = options.lidar_frame,
            .child = options.camera_frame,
            .parent_from_child = result.cam_from_lidar.Inverse(),
            .camera_frame = options.camera_frame};
  }
  return {.parent = options.camera_frame,
          .child = options.lidar_frame,
          .parent_from_child = result.cam_from_lidar,
          .camera_frame = options.camera_frame};
}

}  // namespace

// Frames are the only text of others in these formats: XML, where "--" would end the comment, YAML,
// Python and lines of arguments. No such name needs an escape in any of them.
Expected<void> CheckFrame(const std::string& name, std::string_view whose) {
  std::string without_slashes = name.starts_with('/') ? name.substr(1) : name;
  std::ranges::replace(without_slashes, '/', '_');
  if (IsFileName(without_slashes) && name.find("--") == std::string::npos) return {};
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("the {}'s frame is named {}: expected {}, no \"--\", and slashes",
                               whose, Quoted(name), kFileNameRule));
}

const std::vector<ExportFormat>& ExportFormats() {
  static const std::vector<ExportFormat> formats = {
      {"ros1", "static transform of ROS 1, a .launch file", true},
      {"ros2", "static transform of ROS 2, a .launch.py file", true},
      {"ros2_yaml", "the same as a launch file in YAML", true},
      {"tf_yaml", "geometry_msgs/TransformStamped as YAML", true},
      {"urdf", "fixed joint of a robot's description", true},
      {"kitti", "calib.txt of KITTI: Tr_velo_to_cam and P", false},
      {"opencv", "OpenCV's FileStorage: matrix, rvec, tvec and the camera", false},
      {"matrix", "plain 4x4, rows of four numbers", false}};
  return formats;
}

Expected<std::string> ExportTransform(std::string_view format, const CalibrationResult& result,
                                      const ExportOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckFrames(options));
  const NamedTransform named = Named(result, options);
  const std::span<const NamedTransform> tree(&named, 1);
  const Camera* camera = result.camera ? &*result.camera : nullptr;
  if (format == "ros1") return Ros1LaunchText(tree);
  if (format == "ros2") return Ros2LaunchText(tree);
  if (format == "ros2_yaml") return Ros2YamlText(tree);
  if (format == "tf_yaml") return TfYamlText(named);
  if (format == "urdf") return UrdfText(tree);
  if (format == "opencv") return OpenCvText(result.cam_from_lidar, camera);
  if (format == "matrix") {
    return MatrixText(result.cam_from_lidar, options.camera_frame, options.lidar_frame);
  }
  if (format == "kitti") {
    if (camera != nullptr) return KittiText(result.cam_from_lidar, *camera);
    return MakeError(ErrorCode::kMissingData,
                     "the format kitti contains the camera matrix P, but the result has no camera; "
                     "expected its key 'camera'");
  }
  std::vector<std::string> known;
  for (const ExportFormat& one : ExportFormats()) known.emplace_back(one.name);
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("no format {}; {}", Quoted(format), SuggestName(format, known)));
}

}  // namespace sextant
