// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "geometry/calibration_problem.h"

namespace sextant {

/// `points.txt` of the original package: N, then N LiDAR points, then N camera points, a point a
/// line, x y z in metres.
///
/// Pair i is corner i mod 4 of board i / 4 in view 0; point_sets holds the same points unpaired.
/// The original writes its LiDAR points already turned by its configured initial rotation R0: a
/// pose found from them is cam_from_lidar * R0^-1.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
Expected<CalibrationProblem> ReadPoints(const std::filesystem::path& path);
Expected<CalibrationProblem> ParsePoints(std::string_view text, const std::string& file);

/// The pairs in that form, each number in the fewest digits that read back the same. Sigmas, ids
/// and everything else of a problem have no place in it.
std::string FormatPoints(std::span<const Pair3d3d> pairs);

}  // namespace sextant
