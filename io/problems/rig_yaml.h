// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "solvers/core/rig_problem.h"

namespace sextant {

/// More sensors are refused: the table of their pairs and the search grow with the square.
inline constexpr std::size_t kMaxRigSensors = 100;

/// The content of a rig file: the problem, and data that no solver may use.
struct RigFile {
  RigProblem problem{};
  std::size_t root = 0;  ///< Index of the sensor in whose frame poses are stated.
  /// Pose of each sensor in a common frame, for simulated data; else empty.
  std::vector<Rigid3d> true_rig_from_sensor{};
};

/// The YAML file `sextant_rig: 1`, by which a user passes what he has extracted himself: corners in
/// images, points, planes and lines in 3D, or returns; docs/formats.md documents every key. Files
/// of cameras are relative to its folder.
///
/// Errors: kIo; kParse (for unknown keys with a suggestion); kNonFinite; kInvalidInput by
/// CheckRigProblem. Time is linear in the file's size; memory is that of ParseYaml
/// (io/text/yaml_node.h) and 32 n^2 bytes for each observation of n pixels, at most 1 GiB in all.
Expected<RigFile> ReadRigFile(const std::filesystem::path& path);
Expected<RigFile> ParseRigFile(std::string_view text, const std::string& file);

/// Reading it again gives the same bits where the points of an observation have one sigma_m: the
/// format has one, that of the first point.
std::string FormatRigFile(const RigFile& rig);

/// Whether the text of a file has the key sextant_rig at its start, after comments.
bool IsRigFile(std::string_view text);

}  // namespace sextant
