// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// A format in which other programs read a transform.
struct ExportFormat {
  const char* name;
  const char* summary;
  bool has_parent;  ///< Whether either sensor may be the parent; else it holds cam_from_lidar.
};

/// ros1, ros2, ros2_yaml, tf_yaml, urdf, kitti, opencv, matrix.
const std::vector<ExportFormat>& ExportFormats();

struct ExportOptions {
  std::string camera_frame = "camera_optical_frame";  ///< Optical frame: x right, y down.
  std::string lidar_frame = "lidar";
  /// ROS and URDF state the pose of the child in its parent, parent_from_child: lidar_from_camera
  /// if the LiDAR is the parent.
  bool lidar_is_parent = true;
};

/// The text of a file of that format. The direction of the transform is stated in its name and in a
/// comment.
/// Errors: kUnknownName for the format, with a suggestion; kInvalidOption for a frame's name that
/// is empty or has characters other than letters, digits, _, -, . and /, and for two equal names;
/// kMissingData if the format needs the camera and the result has none.
Expected<std::string> ExportTransform(std::string_view format, const CalibrationResult& result,
                                      const ExportOptions& options);

}  // namespace sextant
