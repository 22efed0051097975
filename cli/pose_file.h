// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant::cli {

/// cam_from_lidar from whatever file holds one: results of `sextant solve` (.json, the first
/// answer), a YAML file with the key cam_from_lidar, or else a 4x4 matrix, a row a line (of
/// several, as rts.txt of the original package has them, the first). Errors: kIo; kParse;
/// kMissingData.
Expected<Rigid3d> ReadPoseFile(const std::string& path);

}  // namespace sextant::cli
