// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A pose that another program computed.
struct ImportedPose {
  std::string solver;
  Rigid3d cam_from_lidar;
  std::string condition;          ///< The experiment's; empty: any.
  std::uint64_t trial = 0;        ///< Its number in that condition.
  std::optional<double> time_us;  ///< What it took; not known without.
};

/// Reads poses as comma-separated values; the first line names the columns, in any order: solver,
/// x, y, z (m), qw, qx, qy, qz (a unit quaternion to 1e-3), and optionally condition, trial and
/// time_us. The poses of one solver differ in condition or trial.
/// Errors: kIo, kParse, kNonFinite, with line and field. Time is O(n log n) in the poses.
Expected<std::vector<ImportedPose>> ReadImportedPoses(const std::filesystem::path& path);
Expected<std::vector<ImportedPose>> ParseImportedPoses(std::string_view text,
                                                       const std::string& file);

}  // namespace sextant
