// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/core/solver.h"

namespace sextant {

/// The input of the solvers.
struct ResultInput {
  std::string path;
  std::string format;  ///< "points.txt", "yaml" and so on.
  int pairs_3d3d = 0;
  int pairs_2d3d = 0;
  int points_in_cam = 0;    ///< Size of the point set in the camera frame.
  int points_in_lidar = 0;  ///< Size of the point set in the LiDAR frame.
};

/// One solver's report, or the error that it returned.
struct SolverResult {
  std::string solver;  ///< Canonical name.
  Expected<SolveReport> report;
};

/// The machine-readable result of `sextant solve` and `sextant compare`.
struct ResultFile {
  std::string version;  ///< Version of sextant that wrote it.
  ResultInput input;
  std::vector<SolverResult> results;
};

/// Formats JSON, documented in docs/formats.md; the keys are stable. A number that JSON cannot
/// represent (the residual of a pair that does not project) is null.
std::string FormatResults(const ResultFile& results);

/// Reads such a file. Stages and the evaluation's cost are not part of it and stay empty.
/// Errors: kIo, kParse with file and key. Time is linear in the file's size, memory at most 40
/// times it.
Expected<ResultFile> ReadResults(const std::filesystem::path& path);
Expected<ResultFile> ParseResults(std::string_view text, const std::string& file);

}  // namespace sextant
