// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "io/clouds/pcd_header.h"

namespace sextant {

/// Reads a scan from a PCD file (Point Cloud Library, versions 0.6 and 0.7): ascii, binary or
/// binary_compressed. Fields of any type are found by the names of io/clouds/cloud_columns.h; those
/// of several values a point, padding and others are skipped. Rings are kept as they are in the
/// file; a point with a coordinate that is not finite becomes NaN throughout. VIEWPOINT is not
/// applied.
///
/// Errors: kIo; kParse and kNonFinite with file and line. Counts in the header are checked against
/// the data before memory is allocated: memory is at most 40 times the file's size, that of
/// compressed data 64 times and 64 MiB. Time is linear in the size and in the points.
Expected<PointCloud> ReadPcd(const std::filesystem::path& path);
Expected<PointCloud> ParsePcd(std::string_view text, const std::string& file);

/// Formats x, y, z, intensity and time as 4-byte floats and ring as 2 bytes; fields that the cloud
/// does not have are omitted.
std::string FormatPcd(const PointCloud& cloud, PcdEncoding encoding = PcdEncoding::kBinary);

}  // namespace sextant
