// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Reads `points.txt` of the original package: N, then N LiDAR points, then N camera points, one
/// point per line, x y z in metres.
///
/// Pair i is corner i mod 4 of board i / 4 in view 0; point_sets holds the same points unpaired.
/// The original package writes LiDAR points that it has already rotated by the configured initial
/// rotation R0: a pose estimated from them is cam_from_lidar * R0^-1.
/// Errors: kIo, kParse, kNonFinite, with file, line and field.
/// Time is linear in the file's size, O(n log n) in the points; memory is at most 60 times the
/// size.
Expected<CalibrationProblem> ReadPoints(const std::filesystem::path& path);
Expected<CalibrationProblem> ParsePoints(std::string_view text, const std::string& file);

/// Formats such a file, numbers in the shortest form that reads back to the same bits. The format
/// has only points: no sigmas, ids or other parts of a problem.
std::string FormatPoints(std::span<const Pair3d3d> pairs);

}  // namespace sextant
