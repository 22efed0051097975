// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// Reads `rts.txt` of the original package: 4x4 matrices, one row per line, each cam_from_lidar of
/// one camera (m).
/// Errors: kIo; kParse (also a matrix that is not a rigid transform to 1e-5); kNonFinite.
/// Time is linear in the file's size, memory at most 20 times it.
Expected<std::vector<Rigid3d>> ReadTransformList(const std::filesystem::path& path);
Expected<std::vector<Rigid3d>> ParseTransformList(std::string_view text, const std::string& file);

}  // namespace sextant
