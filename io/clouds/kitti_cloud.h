// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// Reads a scan of the KITTI data sets (Geiger et al. 2012): x, y, z [m] and intensity as little
/// endian float32, one point after the other. The format has no header by which to recognise it.
/// Errors: kIo; kParse if the file is empty or its size is not a multiple of 16 bytes. Time is
/// linear in the file's size; memory is at most 8 times it.
Expected<PointCloud> ReadKittiCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseKittiCloud(std::string_view bytes, const std::string& file);

}  // namespace sextant
