// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// Reads the element `vertex` of a PLY file (Turk 1994): ascii, binary_little_endian or
/// binary_big_endian. Properties are found by the names of io/clouds/cloud_columns.h; other
/// properties, lists and the elements before `vertex` are skipped, and what follows it is not read.
/// Errors: kIo; kParse and kNonFinite with the line (header, ascii) or the byte (binary), vertex
/// and property. Time is linear in the file's size, whatever its header states; memory is at most
/// 40 times it.
Expected<PointCloud> ReadPly(const std::filesystem::path& path);
Expected<PointCloud> ParsePly(std::string_view bytes, const std::string& file);

using PlyColor = std::array<unsigned char, 3>;  ///< Red, green, blue.

/// Formats binary_little_endian: x, y, z and, if the cloud has it, intensity as 4-byte floats, and
/// a colour per point if any are given.
std::string FormatPly(const PointCloud& cloud, std::span<const PlyColor> colors = {});

}  // namespace sextant
