// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace sextant {

/// Whether a path is named as a recording of ROS is: .bag, .db3 or .mcap. The file is not read.
inline bool IsRecording(const std::filesystem::path& path) {
  const std::string extension = path.extension().string();
  return extension == ".bag" || extension == ".db3" || extension == ".mcap";
}

}  // namespace sextant
