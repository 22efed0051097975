// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "report/boards_report.h"

namespace sextant {

/// Draws the scan around its boards as seen from the sensor: azimuth to the right, elevation up,
/// returns coloured by range, with the outlines and corners found. The file (.png, .jpg, by its
/// name) is written whole or not at all.
/// Errors: kIo, kInvalidOption for another extension, and those of ReadCloud.
Expected<void> DrawScan(const std::string& scan, const ScanReport& report,
                        const std::vector<Board>& boards, const std::filesystem::path& out);

}  // namespace sextant
