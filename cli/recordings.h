// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/error.h"
#include "simulator/scene/scene.h"
#include "simulator/scene/truth_yaml.h"
#include "simulator/session/session.h"

// Recordings of ROS. A build without their libraries defines these functions in
// recordings_absent.cc; they then return kMissingData, with the packages to install.
namespace sextant::cli {

struct OpenedRecording {
  std::string summary{};  ///< The topics and which scans and images are pairs, for people.
  /// Writes scans (PCD), images (encoded ones unchanged, others as PNG), cameras (camera_info YAML,
  /// if different from the one before) and pairs.csv into the folder, a folder for each topic.
  /// Returns the number of files. Errors: those of io/output; kMissingData if there is nothing to
  /// extract; those of the messages.
  std::function<Expected<int>(const std::string& folder)> extract{};
};

/// `tolerance_s`: how far apart the stamps of a scan and an image of a pair may be. Errors: those
/// of OpenBag and ReadStreams.
Expected<OpenedRecording> OpenRecording(const std::string& path, double tolerance_s);

/// Whether a session with these options can be written as a recording. Errors: kInvalidOption for a
/// level without scans and images, and for a session that is longer than ROS can count.
Expected<void> CheckSessionBag(const SessionOptions& options);

/// Writes session.bag (ROS 1) into the folder of a complete session, from its files, whole or not
/// at all: /lidar/points, /<camera>/image_raw and /<camera>/camera_info (docs/formats.md). The same
/// files give the same bytes. Errors: those of the files' readers, with the file, and of
/// OutputFile.
Expected<void> WriteSessionBag(const std::filesystem::path& folder, const Scene& scene,
                               const std::vector<ScanTruth>& scans);

}  // namespace sextant::cli
