// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "geometry/calibration_problem.h"

namespace sextant {

/// The content of a problem file: the problem, and data that no solver may use.
struct ProblemFile {
  CalibrationProblem problem;
  std::optional<Rigid3d> true_cam_from_lidar;  ///< For simulated data.
  std::string comment;                         ///< Source of the data; free text.
};

/// The YAML problem file `sextant_problem: 1`; docs/formats.md documents every key.
///
/// Writing and reading again gives the same bits. If the file has no point sets, they are those of
/// its 3D-3D pairs without the pairing.
/// Errors: kIo; kParse (for unknown keys with a suggestion); kNonFinite; each with the line.
/// Time is linear in the file's size, and in the product of views and boards (at most kMaxBoards);
/// memory is that of ParseYaml (io/text/yaml_node.h) and of the problem.
Expected<ProblemFile> ReadProblemYaml(const std::filesystem::path& path);
Expected<ProblemFile> ParseProblemYaml(std::string_view text, const std::string& file);
std::string FormatProblemYaml(const ProblemFile& file);

}  // namespace sextant
