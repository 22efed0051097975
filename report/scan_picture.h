// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/boards_report.h"

namespace sextant::cli {

/// Draws the scan as the sensor sees it, around its boards: azimuth across, elevation up, returns
/// coloured by range, the outlines and corners found. The file (.png) appears whole or not at all.
/// Errors: kIo, and those of ReadCloud.
Expected<void> DrawScan(const std::string& scan, const ScanReport& report,
                        const std::vector<Board>& boards, const std::filesystem::path& out);

}  // namespace sextant::cli
