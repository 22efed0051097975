// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "features/lidar/corner_extractor.h"

namespace sextant {

/// The result of the search in one scan.
struct ScanReport {
  std::string path{};
  std::optional<Error> failure{};  ///< Set if the scan could not be read; then the rest is empty.
  int returns = 0;
  int rings = 0;
  BoardSearch search{};
  std::vector<Expected<LidarCorners>> corners{};  ///< One for each board found.
};

/// For people: every board with its corners and checks, and the reason for each that was not found.
std::string DescribeScans(const std::vector<ScanReport>& reports, const std::vector<Board>& boards,
                          const std::string& extractor);

/// For programs; see docs/formats.md.
std::string ScansJson(const std::vector<ScanReport>& reports, const std::vector<Board>& boards,
                      const std::string& extractor);

}  // namespace sextant
