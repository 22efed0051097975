// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A photo and a scan that a check compared.
struct CheckedPair {
  std::string name{};
  std::string image_path{};
  std::string cloud_path{};
};

/// The answer of `sextant check` on a given pose, for those who did not run it.
struct CheckResult {
  std::string version{};    ///< Version of sextant that wrote it.
  std::string pose_path{};  ///< The file of the given pose.
  std::string read_as{};    ///< The direction in which it was read: "cam_from_lidar", ...
  std::string read_by{};    ///< What that follows from; a phrase for people.
  std::string state{};      ///< "still valid", "moved" or "cannot tell".
  bool is_certain = false;  ///< The pose has changed, by however little.
  std::string reason{};
  Rigid3d cam_from_lidar{};        ///< The given pose.
  std::optional<Camera> camera{};  ///< None: unknown.
  std::vector<CheckedPair> pairs{};
  /// PoseDifference(measured pose, given pose): (dphi [rad], dt [m]) in the axes of the camera.
  Vector6d change = Vector6d::Zero();
  std::optional<Vector6d> sigma{};  ///< None beyond the limit of the search, or if unknown.
  double detect_rad = 0.0;          ///< The change that has to be seen.
  double detect_m = 0.0;
};

/// (dphi [rad], dt [m]) in degrees and millimetres.
std::array<double, 6> InDegreesAndMm(const Vector6d& value);

/// The JSON of `sextant check --json`; docs/formats.md documents its keys.
std::string FormatCheckResult(const CheckResult& result);

/// Errors: kParse and kNonFinite with file, line and key. Time is linear in the file's size; memory
/// is that of ParseYaml (io/text/yaml_node.h).
Expected<CheckResult> ParseCheckResult(std::string_view text, const std::string& file);

/// Whether a text is that of a check.
bool IsCheckResult(std::string_view text);

}  // namespace sextant
