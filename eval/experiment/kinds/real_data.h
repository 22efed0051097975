// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "base/error.h"
#include "io/problems/data_manifest.h"

namespace sextant {

/// The folder of the real data, as the tests find it: SEXTANT_DATA, else ../../shared/data from the
/// experiment file. It may not exist.
std::filesystem::path RealDataFolder(const std::filesystem::path& experiments);

/// A file in that folder. Error: kMissingData.
Expected<std::filesystem::path> RealFile(const std::string& name,
                                         const std::filesystem::path& experiments);

/// A data set whose files are there and are the manifest's.
struct RealDataSet {
  DataManifest manifest;
  std::filesystem::path data;    ///< The folder of the real data.
  std::filesystem::path beside;  ///< The folder of the manifest.
  /// `name` beside the manifest, or else in the real data.
  std::filesystem::path Find(const std::string& name) const;
};

/// Reads the manifest, relative to the experiment file, and checks its files. Errors: those of
/// ReadManifest and CheckFiles, kMissingData where data is absent. Time and memory are theirs.
Expected<RealDataSet> OpenRealData(const std::string& manifest,
                                   const std::filesystem::path& experiments);

}  // namespace sextant
