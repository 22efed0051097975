// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/running_average_row.h"

namespace sextant {

/// Reads `avg_values.txt` of the original package: 8 lines per iteration, which are its number, the
/// running mean translation (x, y, z, one line each; m), three rows of the running rotation, and
/// the RMSE of that scan under this pose (m). Iterations count from 1.
/// Errors: kIo, kParse (also a matrix that is not a rotation to its printed digits), kNonFinite.
/// Time is linear in the file's size, memory at most 20 times it.
Expected<std::vector<RunningAverageRow>> ReadAverageLog(const std::filesystem::path& path);
Expected<std::vector<RunningAverageRow>> ParseAverageLog(std::string_view text,
                                                         const std::string& file);

}  // namespace sextant
