// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"
#include "io/clouds/pcd_header.h"

namespace sextant {

/// A scan from a PCD file (Point Cloud Library, versions 0.6 and 0.7): ascii, binary or
/// binary_compressed, with the fields, of any type:
/// - x, y, z: needed; a point of which one is not finite becomes NaN throughout.
/// - intensity.
/// - ring: whole numbers up to 65535, as the file counts them.
/// - time, t, timestamp or time_stamp: seconds where floating point, nanoseconds where whole
///   numbers. Times of day, from 1000 s on, become times since the scan's earliest.
/// Other fields are skipped, VIEWPOINT is not applied.
///
/// Errors: kIo; kParse and kNonFinite with file and line. Memory is in proportion to the file's
/// size: no count of the header is believed before the data is there.
Expected<PointCloud> ReadPcd(const std::filesystem::path& path);
Expected<PointCloud> ParsePcd(std::string_view text, const std::string& file);

/// x, y, z, intensity and time as 4-byte floats, ring as 2 bytes; only fields that the cloud has.
std::string FormatPcd(const PointCloud& cloud, PcdEncoding encoding = PcdEncoding::kBinary);

}  // namespace sextant
