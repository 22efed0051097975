// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// A file of a data set, and how to recognise that it is the same one.
struct ManifestFile {
  std::string path;  ///< Relative to the folder of the real data.
  std::uint64_t bytes = 0;
  std::uint32_t crc32 = 0;  ///< ISO 3309, as zlib and PNG have it.
};

/// A pose of a data set that was determined by others, and how good it is.
struct ReferencePose {
  Rigid3d cam_from_lidar;
  std::string from;       ///< Who determined it, and how.
  double sigma_mm = 0.0;  ///< Its standard error per axis; 0: not known.
  double sigma_deg = 0.0;
};

/// What a data set of real measurements consists of: correspondences (`pairs`), or images and
/// scans.
struct DataManifest {
  std::string name;
  std::string about;   ///< What it shows.
  std::string source;  ///< Where it is from.
  std::string licence;
  std::string pairs;   ///< File of correspondences (io/problems/read_problem.h); else empty.
  std::string images;  ///< Pattern such as folder/*.png; else empty.
  std::string scans;
  std::string boards;        ///< Board file; relative to the manifest, else to the data.
  std::string camera;        ///< Camera file, likewise; may be empty with 3D-3D pairs.
  double metres = 1.0;       ///< Length of the unit of the pairs' points.
  bool lidar_first = false;  ///< 3D-3D pairs without names of columns list the LiDAR's point first.
  std::optional<ReferencePose> reference;
  std::vector<ManifestFile> files;
};

/// Reads a manifest, `sextant_data: 1`; docs/formats.md has every key. Errors: kIo; kParse with
/// file, line and key. Time and memory are those of ParseYaml.
Expected<DataManifest> ReadManifest(const std::filesystem::path& path);
Expected<DataManifest> ParseManifest(std::string_view text, const std::string& file);

/// Whether every file of the manifest is in the folder of the real data as it is stated. Errors:
/// kMissingData for an absent file, kInvalidInput for another size or checksum. Time is linear in
/// their size.
Expected<void> CheckFiles(const DataManifest& manifest, const std::filesystem::path& data);

}  // namespace sextant
