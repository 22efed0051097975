// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/problems/problem_yaml.h"

namespace sextant {

/// The formats of correspondences.
enum class ProblemFormat { kYaml, kPoints, kPairsCsv, kAcfrPoses };

/// "yaml", "points", "csv", "acfr_poses": for JSON and options.
std::string_view ToString(ProblemFormat format);

struct DetectedProblem : ProblemFile {
  ProblemFormat format = ProblemFormat::kYaml;
  std::vector<std::string> notes{};  ///< Corrections made while reading, one line each.
};

/// Reads a problem in any of these formats, recognised by the first line: a single number is
/// points.txt; three numbers separated by commas are poses.csv; names separated by commas are a CSV
/// of pairs; "key: value" is YAML, as is every file named .yaml or .yml.
/// Errors: kIo; kParse, which lists the formats if none matches; kNonFinite; kInvalidInput for
/// coordinates out of range (CheckRange). Time is linear in the file's size, but for the order of
/// corners in poses.csv; memory is at most 60 times the size and 64 MiB.
Expected<DetectedProblem> ReadProblem(const std::filesystem::path& path);
Expected<DetectedProblem> ParseProblem(std::string_view text, const std::string& file);

}  // namespace sextant
