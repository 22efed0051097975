// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "base/error.h"
#include "simulator/scene/scene.h"
#include "simulator/scene/truth_yaml.h"
#include "simulator/session/session.h"

namespace sextant::cli {

/// Whether a session of these options can be written as a recording. Errors: kMissingData where
/// this build has no recordings of ROS, with how to get them; kInvalidOption for a level without
/// scans and images, and for a session that is longer than ROS counts time.
Expected<void> CheckSessionBag(const SessionOptions& options);

/// Writes session.bag (ROS 1) into the folder of a complete session, from its files, whole or not
/// at all: /lidar/points, /<camera>/image_raw and /<camera>/camera_info (docs/formats.md). The same
/// files give the same bytes. Errors: those of the files' readers, with the file; kIo.
Expected<void> WriteSessionBag(const std::filesystem::path& folder, const Scene& scene,
                               const std::vector<ScanTruth>& scans);

}  // namespace sextant::cli
