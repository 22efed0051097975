// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "features/lidar/board_finder.h"

namespace sextant::cli {

/// How a user restricts and tunes the search for boards in scans.
struct SearchArguments {
  std::vector<double> region{};  ///< Low and high corner in the LiDAR frame [m]; empty: everywhere.
  bool raw_edges = false;
  std::string lidar = "vlp16";         ///< Whose beam.
  std::optional<double> aperture_m{};  ///< Both ways, where the sensor is not among them...
  std::optional<double> divergence_rad{};
  std::optional<double> growth{};
  std::uint64_t seed = 1;
};

/// Errors: kInvalidOption for a region whose corners are the wrong way round; kUnknownName for the
/// sensor.
Expected<BoardSearchOptions> SearchOptionsFrom(const SearchArguments& arguments);

/// "name: value" of each, as a result's configuration lists them.
std::vector<std::string> ConfigurationOf(const SearchArguments& arguments);

}  // namespace sextant::cli
