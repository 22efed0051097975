// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/problems/problem_yaml.h"

namespace sextant {

/// The formats that hold the pairs of one calibration.
enum class ProblemFormat { kYaml, kPoints, kPairsCsv, kAcfrPoses };

/// "yaml", "points", "csv", "acfr_poses": for JSON and options.
std::string_view ToString(ProblemFormat format);

struct DetectedProblem : ProblemFile {
  ProblemFormat format = ProblemFormat::kYaml;
  std::vector<std::string> notes{};  ///< What was put right while reading, a line each.
};

/// Reads a problem in whichever format the file is, told by its first line: a count alone is
/// points.txt; three numbers between commas are poses.csv; names between commas are a CSV of
/// pairs; "key: value" is YAML, as is every file named .yaml or .yml.
/// Errors: kIo; kParse, which names the formats where none fits; kNonFinite.
Expected<DetectedProblem> ReadProblem(const std::filesystem::path& path);
Expected<DetectedProblem> ParseProblem(std::string_view text, const std::string& file);

}  // namespace sextant
