// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Reads pairs as comma-separated values; the first line names the columns, in any order.
/// - 2D-3D: u, v (px), x, y, z (LiDAR, m), and optionally sigma_px;
/// - 3D-3D: camx, camy, camz, lidarx, lidary, lidarz (m), and optionally sigma_m;
/// - either, optionally: view, board and corner, or id: `board:corner`, `view:board:corner`, or a
///   number n for a point of no board, which is corner 0 of board n. Without these, row i is corner
///   0 of board i.
/// A file holds one kind. 3D-3D pairs also fill point_sets. A 2D-3D file has no camera.
/// Errors: kIo; kParse (for an unknown column with a suggestion); kNonFinite; with line and field.
/// Time is linear in the file's size, O(n log n) in the pairs; memory is at most 60 times the size.
Expected<CalibrationProblem> ReadPairsCsv(const std::filesystem::path& path);
Expected<CalibrationProblem> ParsePairsCsv(std::string_view text, const std::string& file);

/// Formats such a file with all columns; an unknown sigma is 0. Covariances are not written.
std::string FormatPairsCsv(std::span<const Pair2d3d> pairs);
std::string FormatPairsCsv(std::span<const Pair3d3d> pairs);

}  // namespace sextant
