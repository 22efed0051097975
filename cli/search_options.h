// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "cli/command.h"
#include "features/lidar/board_finder.h"

namespace sextant::cli {

/// The options of every command that searches scans for boards.
struct SearchArguments {
  std::vector<double> region{};  ///< Low and high corner in the LiDAR frame [m]; empty: everywhere.
  bool raw_edges = false;
  std::string lidar = "vlp16";         ///< Sensor that determines the width of the beam.
  std::optional<double> aperture_m{};  ///< Each of these replaces that of the sensor.
  std::optional<double> divergence_rad{};
  std::optional<double> growth{};
  std::uint64_t seed = 1;
};

void DeclareSearch(SearchArguments& search, Arguments& arguments);

/// Errors: kInvalidOption for a region whose low corner is not below its high corner; kUnknownName
/// for the sensor.
Expected<BoardSearchOptions> SearchOptionsFrom(const SearchArguments& arguments);

/// One line "name: value" per option, for the configuration in a result.
std::vector<std::string> ConfigurationOf(const SearchArguments& arguments);

}  // namespace sextant::cli
