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

/// The element `vertex` of a PLY file (Turk 1994): ascii, binary_little_endian, binary_big_endian.
/// Properties are taken by the names of io/clouds/cloud_columns.h; other properties, lists and the
/// elements before `vertex` are skipped, what follows it is not looked at. Errors: kIo; kParse and
/// kNonFinite with the line (header, ascii) or the byte (binary), vertex and property. Memory: no
/// more than the file has room for, whatever its header states.
Expected<PointCloud> ReadPly(const std::filesystem::path& path);
Expected<PointCloud> ParsePly(std::string_view bytes, const std::string& file);

using PlyColor = std::array<unsigned char, 3>;  ///< Red, green, blue.

/// binary_little_endian: x, y, z and, where the cloud has it, intensity as 4-byte floats; a colour
/// a point where any are given.
std::string FormatPly(const PointCloud& cloud, std::span<const PlyColor> colors = {});

}  // namespace sextant
