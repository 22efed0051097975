// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/core/solver.h"

namespace sextant {

/// What the solvers were given.
struct ResultInput {
  std::string path;
  std::string format;  ///< "points.txt", "yaml" and so on.
  int pairs_3d3d = 0;
  int pairs_2d3d = 0;
  int points_in_cam = 0;    ///< Of the point sets.
  int points_in_lidar = 0;  ///< Of the point sets.
};

/// One solver's answer, or why there is none.
struct SolverResult {
  std::string solver;  ///< Canonical name.
  Expected<SolveReport> report;
};

/// The machine-readable result of `sextant solve` and `sextant compare`.
struct ResultFile {
  std::string version;  ///< Of the sextant that wrote it.
  ResultInput input;
  std::vector<SolverResult> results;
};

/// JSON, documented in docs/formats.md; the keys are a contract. A number that JSON cannot hold
/// (the residual of a pair that does not project) is null.
std::string FormatResults(const ResultFile& results);

/// Reads it back: all but stages and the evaluation's cost, which the file does not hold.
/// Errors: kIo, kParse with file and key.
Expected<ResultFile> ReadResults(const std::filesystem::path& path);
Expected<ResultFile> ParseResults(std::string_view text, const std::string& file);

}  // namespace sextant
