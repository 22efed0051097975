// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// Reads pairs, one a line; the first line names the columns, in any order.
/// - 2D-3D: u, v (px), x, y, z (LiDAR, m), and optionally sigma_px;
/// - 3D-3D: camx, camy, camz, lidarx, lidary, lidarz (m), and optionally sigma_m;
/// - either, optionally: view, board and corner, or id: `board:corner`, `view:board:corner`, a
///   number n for a point of no board, which is corner 0 of board n, or a name, such as p2. Without
///   these, and with names, row i is corner 0 of board i.
/// Columns are separated by commas, semicolons (then numbers may have decimal commas), tabs or
/// blanks. See ReadCsvHeader for the names of other programs, and for files without names.
/// A file holds one kind. 3D-3D pairs also fill point_sets. A 2D-3D file has no camera.
/// `notes` gets a sentence for each assumption about the columns.
/// Errors: kIo; kParse (for an unknown column with a suggestion); kNonFinite; with line and field.
/// Time is linear in the file's size, O(n log n) in the pairs; memory is at most 60 times the size.
Expected<CalibrationProblem> ReadPairsCsv(const std::filesystem::path& path);
Expected<CalibrationProblem> ParsePairsCsv(std::string_view text, const std::string& file);
Expected<CalibrationProblem> ParsePairsCsvWithNotes(std::string_view text, const std::string& file,
                                                    std::vector<std::string>& notes);

/// Formats such a file with all columns; an unknown sigma is 0. Covariances are not written.
std::string FormatPairsCsv(std::span<const Pair2d3d> pairs);
std::string FormatPairsCsv(std::span<const Pair3d3d> pairs);

}  // namespace sextant
