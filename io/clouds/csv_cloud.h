// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// A scan as comma-separated values, a point a line. The first line names the columns, in any
/// order, by the names of io/clouds/cloud_columns.h (also VeloView's, in quotes); others are left
/// alone. Times are in seconds unless the name says otherwise. A coordinate may be nan: a ray
/// without a return. Errors: kIo; kParse; kNonFinite; with line, field and its name.
Expected<PointCloud> ReadCsvCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseCsvCloud(std::string_view text, const std::string& file);

}  // namespace sextant
