// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "calibrate/session/file_pairs.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// The input of a calibration: paths of the boards, of the camera, and of images and scans. One
/// camera and one LiDAR; several cameras are calibrated one by one. Empty members are not
/// specified.
struct Session {
  std::filesystem::path boards{};  ///< Board file (YAML).
  std::filesystem::path camera{};  ///< Camera file.
  FilePairs files{};
  std::filesystem::path bag{};  ///< A recording instead of files.
  std::string image_topic{};    ///< In the recording; empty: the only one.
  std::string cloud_topic{};
  std::optional<Rigid3d> initial_cam_from_lidar{};
  std::optional<Rigid3d> true_cam_from_lidar{};  ///< Simulated sessions; not given to solvers.
};

/// Reads a session by its path:
/// - a YAML file (docs/formats.md), whose paths are relative to its folder;
/// - a folder with session.yaml in it;
/// - a folder that `sextant simulate` wrote: boards.yaml, <camera>_info.yaml, <camera>_*.png,
///   scan_*.pcd, truth.yaml; `camera_name` selects one of several cameras (empty: the first);
/// - a recording of ROS: a file that ends in .bag, .db3 or .mcap, or a folder with one.
/// Errors: kIo; kParse with file, line and key; kMissingData for a folder that is none of these and
/// for a folder without a camera of that name; kInvalidOption for a name where there are none.
/// Time is linear in the file or the folder, O(n log n) in the names; memory: 1 KiB for each name,
/// or that of ParseYaml (io/text/yaml_node.h).
Expected<Session> ReadSession(const std::filesystem::path& path,
                              const std::string& camera_name = "");
/// The text of a session file. `file` is its path: for messages, and for the folder that the paths
/// in it start from.
Expected<Session> ParseSession(std::string_view text, const std::string& file);

/// A session of images and scans by their paths, of which each may be a pattern with `*`; paired by
/// PairFiles. It names neither boards nor camera. Errors: those of ExpandPattern.
Expected<Session> SessionOfFiles(std::span<const std::string> images,
                                 std::span<const std::string> clouds);

}  // namespace sextant
