// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "geometry/camera.h"
#include "io/text/yaml_fields.h"

namespace sextant {

/// A map of a file that holds one camera's intrinsics, whatever the program that wrote it.
struct CameraNode {
  std::string name;  ///< Key of the map, such as cam0; empty for the root.
  const YamlNode* map = nullptr;
  /// KITTI's projection matrix, where that is all there is.
  const YamlNode* projection = nullptr;
};

/// All of them, in the order of the file.
std::vector<CameraNode> FindCameras(const YamlNode& root);

/// The value of the first of these keys that a camera has, also in its groups of parameters
/// (camodocal); null if there is none.
const YamlNode* FindCameraKey(const YamlNode& camera, const std::vector<std::string_view>& keys);

/// The numbers of a list, of a list of rows, of a matrix {rows, cols, data}, or of a text that
/// separates them by blanks; an error for more than `max_size`.
std::vector<double> CameraNumbers(YamlFields& in, const YamlNode& node, std::string_view name,
                                  std::size_t max_size);

/// The camera of a tree; `name` chooses one of several. Errors: as ParseCamera.
Expected<Camera> CameraOfTree(const YamlNode& root, const std::string& file, std::string_view name);

/// An OpenCV FileStorage in XML as a tree. Error: kParse, also for more than 1 MiB. Time and memory
/// are linear in the size.
Expected<YamlNode> ParseCameraXml(std::string_view text, const std::string& file);

}  // namespace sextant
