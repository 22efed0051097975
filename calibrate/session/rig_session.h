// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/session/file_pairs.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A camera or a LiDAR of a session, by its files.
struct SessionSensor {
  std::string name{};
  std::filesystem::path camera{};              ///< Camera file; empty: a LiDAR.
  std::vector<std::filesystem::path> files{};  ///< Its images, or its scans.
  std::optional<Rigid3d> true_rig_from_sensor{};
};

/// The input of a rig's calibration: any number of cameras and LiDARs. Whatever was recorded
/// together has the same distinguishing part of its file name; a moment may lack some sensors.
struct RigSession {
  std::filesystem::path boards{};
  std::vector<SessionSensor> sensors{};
  std::size_t root = 0;               ///< The sensor in whose frame poses are stated.
  std::vector<FileMoment> moments{};  ///< Files in the order of the sensors.
};

/// The rig at a path; none where the session has one camera and one LiDAR, or is no session that
/// ReadSession knows:
/// - a session file with the key sensors, or a folder with such a session.yaml;
/// - a folder that `sextant simulate` wrote of a scene with several cameras.
/// Errors: kIo; kParse with file, line and key; kMissingData for patterns without a file, and for a
/// folder of more than 100 cameras.
/// Time is that of ExpandPattern for each sensor, of at most 100; memory: 1 KiB for each name, and
/// that of ParseYaml (io/text/yaml_node.h).
Expected<std::optional<RigSession>> ReadRigSession(const std::filesystem::path& path);

}  // namespace sextant
