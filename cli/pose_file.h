// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant::cli {

/// Reads cam_from_lidar from results of `sextant solve` (.json, the first answer), from a YAML file
/// with the key cam_from_lidar, or else from a 4x4 matrix with one row per line (the first matrix,
/// if there are several as in rts.txt of the original package). Errors: kIo; kParse; kMissingData.
/// Time and memory are those of the three formats' readers.
Expected<Rigid3d> ReadPoseFile(const std::string& path);

}  // namespace sextant::cli
