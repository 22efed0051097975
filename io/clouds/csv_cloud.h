// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// Reads a scan as a table, one point per line: values separated by semicolons, commas or blanks,
/// as in the first line. That line names the columns, in any order, by the names of
/// io/clouds/cloud_columns.h (VeloView's are in quotes); other columns are ignored. If it is
/// numbers the columns are those of UnnamedColumns; a first line of one number (.pts) is skipped.
/// Numbers between semicolons or tabs may have decimal commas.
/// Times are in seconds unless the name states another unit. A point with a coordinate nan is a ray
/// without a return. Errors: kIo; kParse; kNonFinite; with line, field and its name. Time is linear
/// in the file's size; memory is at most 20 times it.
Expected<PointCloud> ReadCsvCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseCsvCloud(std::string_view text, const std::string& file);

}  // namespace sextant
