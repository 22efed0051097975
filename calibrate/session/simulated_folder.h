// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

// The folders that `sextant simulate` writes: <camera>_info.yaml, <camera>_<number>.png, scans, and
// truth.yaml.
namespace sextant {

struct SimulatedCamera {
  std::string name{};
  std::filesystem::path info{};
};

/// The cameras that have an info file; at least one. Errors: those of ExpandPattern.
Expected<std::vector<SimulatedCamera>> SimulatedCameras(const std::filesystem::path& folder);

/// The images of one camera: with cameras cam and cam_right, cam_*.png also matches those of
/// cam_right. Errors: those of ExpandPattern.
Expected<std::vector<std::filesystem::path>> SimulatedImages(const std::filesystem::path& folder,
                                                             const std::string& camera);

/// The true cam_from_lidar of each camera in truth.yaml, of which everything else is ignored; empty
/// without that file. Errors: kIo; kParse.
Expected<std::map<std::string, Rigid3d>> SimulatedTruth(const std::filesystem::path& folder);

}  // namespace sextant
