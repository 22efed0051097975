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

/// Reads a scan from an array of NumPy (.npy, versions 1 to 3): float32 or float64 of either byte
/// order, points x 3 to 6 columns, in C or Fortran order. The columns are those of UnnamedColumns.
/// Errors: kIo; kParse, with the byte. The shape is checked against the file's size before memory
/// is allocated. Time is linear in the size; memory is at most 8 times it.
Expected<PointCloud> ReadNpyCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseNpyCloud(std::string_view bytes, const std::string& file);

}  // namespace sextant
