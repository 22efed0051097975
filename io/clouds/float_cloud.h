// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// Reads a scan of the KITTI data sets (Geiger et al. 2012): x, y, z [m] and intensity as little
/// endian float32, one point after the other; or of nuScenes (Caesar et al. 2020), where a fifth
/// number is the ring; or three to eight numbers of which the first three are coordinates. The
/// format has no header by which to recognise it; a file has five numbers a point if every fifth is
/// a ring (IsRingNumber) and the others are not all such numbers too, else as many as make the
/// columns differ most, four unless another count is clear.
/// Errors: kIo; kParse if the file is empty, its size fits none, or many numbers cannot be metres.
/// Time is linear in the file's size; memory is at most 8 times it.
Expected<PointCloud> ReadFloatCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseFloatCloud(std::string_view bytes, const std::string& file);

}  // namespace sextant
