// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "features/lidar/corner_extractor.h"

namespace sextant::cli {

/// What was found in one scan.
struct ScanReport {
  std::string path{};
  std::optional<Error> failure{};  ///< Why it could not be read; then the rest is empty.
  int returns = 0;
  int rings = 0;
  BoardSearch search{};
  std::vector<Expected<LidarCorners>> corners{};  ///< One for each board found.
};

/// For people: every board with its corners and checks, and what was not found and why.
std::string DescribeScans(const std::vector<ScanReport>& reports, const std::vector<Board>& boards,
                          const std::string& extractor);

/// For tools; docs/formats.md.
std::string ScansJson(const std::vector<ScanReport>& reports, const std::vector<Board>& boards,
                      const std::string& extractor);

}  // namespace sextant::cli
