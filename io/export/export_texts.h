// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A transform with the names of its frames: the pose of the child frame in the parent frame.
struct NamedTransform {
  std::string parent;
  std::string child;
  Rigid3d parent_from_child;
  std::string camera_frame;  ///< The camera's frame: parent or child; empty: neither.
};

/// The numbers of a matrix, row by row.
std::string NumbersByRow(const Eigen::MatrixXd& matrix, const char* between);

/// Error: kInvalidOption for a name that would need an escape in one of the formats. `whose`: for
/// the message.
Expected<void> CheckFrame(const std::string& name, std::string_view whose);

/// The texts of ExportTransform and ExportRig, which check the names of the frames;
/// io/export/export_transform.h documents each format.
std::string Ros1LaunchText(std::span<const NamedTransform> tree);
std::string Ros2LaunchText(std::span<const NamedTransform> tree);
std::string Ros2YamlText(std::span<const NamedTransform> tree);
std::string TfYamlText(const NamedTransform& transform);
std::string UrdfText(std::span<const NamedTransform> tree);

std::string KittiText(const Rigid3d& cam_from_lidar, const Camera& camera);
/// `camera` may be null.
std::string OpenCvText(const Rigid3d& cam_from_lidar, const Camera* camera);
std::string MatrixText(const Rigid3d& cam_from_lidar, const std::string& camera_frame,
                       const std::string& lidar_frame);

}  // namespace sextant
