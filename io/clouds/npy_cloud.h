// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// The first bytes of every file of NumPy.
inline constexpr std::string_view kNpyMagic = "\x93NUMPY";

/// Reads a scan from an array of NumPy (.npy, versions 1 to 3), of either byte order:
/// - float32 or float64, points x 3 to 16 columns, in C or Fortran order, rows x columns x 3 to 16
///   of an organised cloud, or 3 to 16 rows of more than 16 points. Columns: UnnamedColumns.
/// - fields with names (a structured array), of any numbers. Columns: FindCloudColumns.
/// Errors: kIo; kParse, with the byte. The shape is checked against the file's size before memory
/// is allocated. Time is linear in the size; memory is at most 8 times it.
Expected<PointCloud> ReadNpyCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseNpyCloud(std::string_view bytes, const std::string& file);

}  // namespace sextant
