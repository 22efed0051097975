// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/calibration_problem.h"

namespace sextant {

/// What a file says of one calibration: the problem, and beside it what no solver may see.
struct ProblemFile {
  CalibrationProblem problem;
  std::optional<Rigid3d> true_cam_from_lidar;  ///< Where the data is simulated.
  std::string comment;                         ///< Where the data comes from; free text.
};

/// The YAML problem file `sextant_problem: 1`; every key stands in docs/formats.md.
///
/// Writing and reading again gives the same bits. Point sets that the file leaves out are those of
/// its 3D-3D pairs, the pairing withheld.
/// Errors: kIo; kParse (unknown keys name the nearest known one); kNonFinite; each with the line.
Expected<ProblemFile> ReadProblemYaml(const std::filesystem::path& path);
Expected<ProblemFile> ParseProblemYaml(std::string_view text, const std::string& file);
std::string FormatProblemYaml(const ProblemFile& file);

}  // namespace sextant
